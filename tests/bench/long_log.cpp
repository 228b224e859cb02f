// Maps a long drive through a large synthetic floor and reports the cost of each step against the
// length of the log: a CSV file, a picture and a summary.
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "cost_picture.hpp"
#include "sample_quantile.hpp"

namespace {

using namespace topogeo;

struct LongLogOptions {
  double path_m = 2000.0;
  std::size_t blocks = 4;
  std::uint64_t seed = 1;
  std::filesystem::path out;
  std::filesystem::path log;
  std::string config_file;
};

// A scan every half metre or 45 degrees: a little over 4,000 scans on 2 km.
simulation::SimulatedLog drive(const LongLogOptions& options) {
  simulation::SimulationOptions simulation;
  simulation.seed = options.seed;
  simulation.scan_step_m = 0.5;
  simulation.scan_step_rad = 45.0 * std::numbers::pi / 180.0;
  simulation.odometry = simulation::b21_odometry(options.seed);
  return simulation::simulate_log(
      simulation::large_floor(options.seed, options.path_m, options.blocks), simulation);
}

double peak_memory_mb() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) throw std::runtime_error("getrusage failed");
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void write_log(const std::filesystem::path& file, const simulation::SimulatedLog& log) {
  scan::CarmenLogWriter writer(file);
  for (const scan::Scan& scan : log.scans) writer.write(scan);
  writer.close();
}

void report(const std::string& what, const std::vector<bench::StepCost>& steps, std::size_t from,
            std::size_t to) {
  std::vector<double> costs_ms;
  double sum_ms = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    costs_ms.push_back(steps[i].cpu_ms);
    sum_ms += steps[i].cpu_ms;
  }
  if (costs_ms.empty()) return;
  std::printf("%s: mean %.2f ms, median %.2f, 95 %% %.2f, 99 %% %.2f, most %.1f\n", what.c_str(),
              sum_ms / static_cast<double>(costs_ms.size()), bench::sample_quantile(costs_ms, 0.5),
              bench::sample_quantile(costs_ms, 0.95), bench::sample_quantile(costs_ms, 0.99),
              bench::sample_quantile(costs_ms, 1.0));
}

// Reports the steps of the kilometre that ends here.
void report_last_kilometre(double at_m, const std::vector<bench::StepCost>& steps) {
  const auto first_after = [&](double path_m) {
    const auto found = std::find_if(steps.begin(), steps.end(), [&](const bench::StepCost& step) {
      return step.path_m > path_m;
    });
    return static_cast<std::size_t>(found - steps.begin());
  };
  report("steps up to " + std::to_string(static_cast<int>(at_m / 1e3)) + " km", steps,
         first_after(at_m - 1e3), first_after(at_m));
}

void write_csv(const std::filesystem::path& file, const std::vector<bench::StepCost>& steps) {
  std::ofstream out(file);
  out << "step,way_m,cpu_ms\n";
  for (std::size_t i = 0; i < steps.size(); ++i) {
    out << i << ',' << steps[i].path_m << ',' << steps[i].cpu_ms << '\n';
  }
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot write");
}

void run_log(const LongLogOptions& options) {
  support::check_writable_directory(options.out);
  const pipeline::Config config =
      pipeline::load_config(options.config_file.empty()
                                ? std::nullopt
                                : std::optional<std::filesystem::path>(options.config_file))
          .config;
  const simulation::SimulatedLog log = drive(options);
  if (!options.log.empty()) write_log(options.log, log);
  const double memory_before_mb = peak_memory_mb();
  pipeline::MappingRun mapping(config, "robot");
  std::vector<bench::StepCost> steps;  // of scans at which a stop was made and matched
  std::vector<topomap::StampedPose> truth;
  double path_m = 0.0;
  const double start_s = support::process_cpu_s();
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (i > 0) {
      path_m += (log.T_world_robot[i].position_m() - log.T_world_robot[i - 1].position_m()).norm();
    }
    const double before_s = support::process_cpu_s();
    const std::uint64_t tasks_before = mapping.match_counts().tasks;
    mapping.add(log.scans[i]);
    if (mapping.match_counts().tasks != tasks_before) {
      steps.push_back({path_m, (support::process_cpu_s() - before_s) * 1000.0});
    }
    truth.push_back({log.scans[i].sequence, log.scans[i].stamp_ns, log.T_world_robot[i]});
  }
  const double added_s = support::process_cpu_s();
  const std::size_t quarter = steps.size() / 4;
  report("steps in the first quarter", steps, 0, quarter);
  report("steps in the last quarter", steps, steps.size() - quarter, steps.size());
  for (const double at_m : {1e3, 2e3, 5e3, 10e3, 20e3}) {
    if (at_m < 1.1 * path_m) report_last_kilometre(at_m, steps);
  }
  std::fflush(stdout);  // the next part takes minutes on a long log
  const storage::MapDocument map = mapping.finish();
  const double end_s = support::process_cpu_s();

  const auto corrected = topomap::expand_trajectory(map.trajectory, map.local_maps);
  const auto odometry = topomap::expand_odometry(map.local_maps);
  std::printf("%zu scans, %zu stops, %.0f m, %zu loop closures\n", log.scans.size(),
              map.local_maps.size(), path_m, map.loop_closures.size());
  std::printf("CPU %.1f s, of which after the last scan %.1f s; memory %.0f MB (%.0f MB before)\n",
              end_s - start_s, end_s - added_s, peak_memory_mb(), memory_before_mb);
  for (const support::StageTime& stage : mapping.stages()) {
    std::printf("  %s: %.1f s\n", stage.stage.c_str(), stage.cpu_s);
  }
  std::printf("rms error %.3f m corrected, %.1f m by odometry\n",
              pipeline::trajectory_error(corrected, truth).rms_m,
              pipeline::trajectory_error(odometry, truth).rms_m);
  write_csv(options.out / "cost.csv", steps);
  bench::draw_costs((options.out / "cost.png").string(), "Cost of a step along a synthetic log",
                    steps);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{
      "what a step costs along a long synthetic log; cost.csv and cost.png in a folder"};
  LongLogOptions options;
  app.add_option("--out", options.out, "folder for the results")->required();
  app.add_option("--way", options.path_m, "metres to drive")
      ->capture_default_str()
      ->check(command_line::range(50.0, 20'000.0));
  app.add_option("--blocks", options.blocks, "of the floor along each side")
      ->capture_default_str()
      ->check(command_line::range(1, 40));
  app.add_option("--log", options.log, "write the scans as a CARMEN log too");
  app.add_option("--seed", options.seed, "of the floor, the drive and the noise")
      ->capture_default_str();
  app.add_option("--config", options.config_file, "configuration file")
      ->check(command_line::existing_file());
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    run_log(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_long_log: %s\n", error.what());
    return 1;
  }
  return 0;
}
