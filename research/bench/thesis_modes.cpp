// Maps recorded logs and the replicas of the thesis's experiments with each of its configurations
// (share/thesis/*.config.yaml) and prints the errors of the poses against the truth.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/experiments/thesis_experiments.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/topomap/trajectory.hpp"
#include "topogeo/world/world.hpp"

#include "recordings.hpp"

namespace {

using namespace topogeo;

struct ThesisModesOptions {
  std::filesystem::path data = std::filesystem::path(TOPOGEO_SOURCE_DIR) / "../shared/data";
  std::vector<std::string> logs;
  std::uint64_t seeds = 3;
  std::vector<std::string> configs{"printed", "topological", "topological_weighted", "combined"};
};

std::filesystem::path thesis_data(const std::string& name) {
  return std::filesystem::path(TOPOGEO_SOURCE_DIR) / "share/thesis" / name;
}

bench::Recording replica(const std::string& name, const simulation::SimulationOptions& options) {
  const simulation::SimulatedLog log =
      simulation::simulate_log(world::load_world(thesis_data(name + ".world.yaml")), options);
  bench::Recording recording{name + "/" + std::to_string(options.seed), log.scans, {}};
  recording.T_world_robot.assign(log.T_world_robot.begin(), log.T_world_robot.end());
  return recording;
}

std::vector<topomap::StampedPose> truth_of(const bench::Recording& recording) {
  std::vector<topomap::StampedPose> truth;
  for (std::size_t i = 0; i < recording.scans.size(); ++i) {
    if (!recording.T_world_robot[i]) continue;
    truth.push_back(
        {recording.scans[i].sequence, recording.scans[i].stamp_ns, *recording.T_world_robot[i]});
  }
  return truth;
}

void print_row(const std::string& log, const std::string& mode, std::size_t stops,
               std::size_t closures, const pipeline::TrajectoryError& error, double cpu_s) {
  const std::string loop = error.loop ? std::to_string(error.loop->mean_m).substr(0, 5) : "-";
  std::printf("| %s | %s | %zu | %zu | %.3f | %s | %.3f | %.1f |\n", log.c_str(), mode.c_str(),
              stops, closures, error.rms_m, loop.c_str(), error.end_m, cpu_s);
  std::fflush(stdout);
}

void map_log(const bench::Recording& recording, const ThesisModesOptions& options) {
  const std::vector<topomap::StampedPose> truth = truth_of(recording);
  bool odometry_shown = false;
  for (const std::string& name : options.configs) {
    const pipeline::Config config =
        name == "default" ? pipeline::load_config(std::nullopt).config
                          : pipeline::load_config(thesis_data(name + ".config.yaml")).config;
    const double before_s = support::process_cpu_s();
    pipeline::MappingRun mapping(config, "robot");
    for (const scan::Scan& scan : recording.scans) mapping.add(scan);
    const storage::MapDocument map = mapping.finish();
    const double cpu_s = support::process_cpu_s() - before_s;
    const localization::SlamCounts counts = mapping.match_counts();
    std::fprintf(stderr, "%s %s: %llu steps in doubt; matches by reason:", recording.name.c_str(),
                 name.c_str(), static_cast<unsigned long long>(counts.steps_in_doubt));
    for (const std::uint64_t count : counts.reasons) {
      std::fprintf(stderr, " %llu", static_cast<unsigned long long>(count));
    }
    std::fprintf(stderr, "\n");
    if (!odometry_shown) {
      print_row(recording.name, "odometry", map.local_maps.size(), 0,
                pipeline::trajectory_error(topomap::expand_odometry(map.local_maps), truth), 0.0);
      odometry_shown = true;
    }
    print_row(recording.name, name, map.local_maps.size(), map.loop_closures.size(),
              pipeline::trajectory_error(topomap::expand_trajectory(map.trajectory, map.local_maps),
                                         truth),
              cpu_s);
  }
}

void run(const ThesisModesOptions& options) {
  std::printf(
      "| log | trajectory | stops | loops closed | ate m | loop m | end m | CPU s |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
    map_log(replica("experiment_1", simulation::thesis_experiment_1(seed)), options);
  }
  for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
    map_log(replica("experiment_2", simulation::thesis_experiment_2(seed)), options);
  }
  for (const std::string& log : options.logs) {
    map_log(bench::recorded((options.data / (log + ".clf.gz")).string(),
                            (options.data / (log + ".ref.tum")).string(), {}),
            options);
  }
}

}  // namespace

int main(int argc, char** argv) {
  ThesisModesOptions options;
  command_line::Command app{"how far maps by each configuration of the thesis are from the truth"};
  app.add_option("LOG", options.logs, "names of logs in the data folder, without .clf.gz");
  app.add_option("--data", options.data, "folder of the logs")->type_name("DIR");
  app.add_option("--seeds", options.seeds, "drives of each replica");
  app.add_option("--configs", options.configs, "names of share/thesis/NAME.config.yaml, or default")
      ->delimiter(',');
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_thesis_modes: %s\n", error.what());
    return 1;
  }
  return 0;
}
