// Does a robot without a laser get where it is sent? Simulated drives in a closed loop on drawn
// floors: from a random base station, by Markov localization with sonars alone.
//
//   topogeo_sonar_arrival [--runs 200] [--sonars 24|6] [--wheels mild|b21] [--grid poses|positions]
//   topogeo_sonar_arrival --floor NAME --run N [--trace FILE.csv]
#include <cstdio>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

#include "parallel_drives.hpp"
#include "sonar_run.hpp"
#include "sonar_table.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

struct SonarArguments {
  std::uint64_t runs = 200;
  std::uint64_t first_run = 1;
  int sonars = 24;
  std::string wheels = "mild";
  std::string grid = "poses";
  unsigned jobs = 2;
  double obstacles = 0.0;
  std::string floor;
  std::optional<std::uint64_t> run;
  std::string trace;
  std::string config;
  bool verbose = false;
};

void declare(command_line::Command& app, SonarArguments& arguments) {
  app.add_option("--runs", arguments.runs, "drives, dealt out to the floors by turns")
      ->capture_default_str();
  app.add_option("--first-run", arguments.first_run, "number and seed of the first one")
      ->capture_default_str();
  app.add_option("--sonars", arguments.sonars, "24 as a B21 has them, or the 6 of MACONDO")
      ->check(command_line::one_of({"24", "6"}))
      ->capture_default_str();
  app.add_option("--wheels", arguments.wheels, "how they err, see simulator --odometry")
      ->check(command_line::one_of({"mild", "b21"}))
      ->capture_default_str();
  app.add_option("--grid", arguments.grid,
                 "poses: positions and headings; positions: MACONDO's window of 21 x 21")
      ->check(command_line::one_of({"poses", "positions"}))
      ->capture_default_str();
  app.add_option("--obstacles", arguments.obstacles,
                 "share of the drives with a box on the route that is not on the map")
      ->check(command_line::range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--jobs", arguments.jobs, "drives at a time; changes no result")
      ->check(command_line::range(1, 64))
      ->capture_default_str();
  app.add_option("--floor", arguments.floor, "this floor only");
  app.add_option("--run", arguments.run, "this drive only");
  app.add_option("--trace", arguments.trace, "of the drive of --run, CSV");
  app.add_option("--config", arguments.config,
                 "settings in place of deploy/sonar_robot.example.yaml");
  app.add_flag("--verbose", arguments.verbose, "one line for each drive as it ends");
}

struct SonarJob {
  std::string floor;
  std::uint64_t run = 0;
};

std::vector<SonarJob> sonar_jobs(const SonarArguments& arguments) {
  const std::vector<std::string> names = bench::drawn_floor_names();
  std::vector<SonarJob> jobs;
  const std::uint64_t first = arguments.run.value_or(arguments.first_run);
  const std::uint64_t count = arguments.run ? 1 : arguments.runs;
  for (std::uint64_t run = first; run < first + count; ++run) {
    jobs.push_back({arguments.floor.empty() ? names.at(run % names.size()) : arguments.floor, run});
  }
  return jobs;
}

using DrawnFloors = std::map<std::string, bench::DrawnFloor>;

bench::SonarRow drive(const SonarJob& job, const DrawnFloors& floors,
                      const bench::SonarDriveConfig& config, const SonarArguments& arguments) {
  const bench::DrawnFloor& floor = floors.at(job.floor);
  const bench::SonarTask task = bench::draw_sonar_task(floor, config, job.run);
  const double begin_s = support::monotonic_s();
  const bench::SonarResult result =
      bench::run_sonar_drive(floor, config, task, arguments.run ? arguments.trace : std::string());
  if (arguments.verbose) {
    std::fprintf(stderr,
                 "%s %llu: %s, %.1f cm, %.1f degrees, pose %.1f cm, at most %.1f cm, %llu "
                 "collisions, %.0f s of %.1f m, %s (%.1f s)\n",
                 job.floor.c_str(), static_cast<unsigned long long>(job.run),
                 result.good() ? "good" : "NOT GOOD", 100.0 * result.error_m,
                 result.heading_error_rad * 57.29578, 100.0 * result.pose_error_m,
                 100.0 * result.largest_pose_m, static_cast<unsigned long long>(result.collisions),
                 result.time_s, task.route_length_m, result.end.c_str(),
                 support::monotonic_s() - begin_s);
  }
  return {job.floor, job.run, task.obstacle, result};
}

std::vector<bench::SonarRow> drive_all(const std::vector<SonarJob>& jobs, const DrawnFloors& floors,
                                       const bench::SonarDriveConfig& config,
                                       const SonarArguments& arguments) {
  return bench::drive_in_parallel<bench::SonarRow>(jobs, arguments.jobs, [&](const SonarJob& job) {
    return drive(job, floors, config, arguments);
  });
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("Does a robot without a laser get where it is sent?");
  SonarArguments arguments;
  declare(app, arguments);
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    bench::SonarDriveConfig config = bench::sonar_drive_config(arguments.config);
    config.sonars = arguments.sonars;
    config.obstacle_share = arguments.obstacles;
    config.system.navigator.markov.grid = arguments.grid == "poses"
                                              ? navigation::MarkovGrid::kPoses
                                              : navigation::MarkovGrid::kPositions;
    if (arguments.grid == "positions") {
      config.system.navigator.markov.cell_m =
          navigation::MarkovTrackerConfig{}.cell_m;  // published
    }
    config.wheels = arguments.wheels == "b21" ? bench::Wheels::kB21 : bench::Wheels::kMild;
    const std::vector<SonarJob> jobs = sonar_jobs(arguments);
    const double begin_s = support::monotonic_s();
    DrawnFloors floors;
    for (const SonarJob& job : jobs) {
      if (floors.contains(job.floor)) continue;
      floors.emplace(job.floor, bench::draw_floor(job.floor, config.system.hybrid_map));
    }
    const std::string table = bench::sonar_table(drive_all(jobs, floors, config, arguments));
    std::printf("%s", table.c_str());
    std::fprintf(stderr, "%.0f s, of CPU %.0f s\n", support::monotonic_s() - begin_s,
                 support::process_cpu_s());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_sonar_arrival: %s\n", error.what());
    return 1;
  }
  return 0;
}
