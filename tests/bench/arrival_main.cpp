// Does a robot get where it is sent? Simulated drives in a closed loop, in one process and on
// simulated time: three floors, each mapped by a drive of its own, then random starts and goals
// with sensor noise, slip, and in a third of the runs an unexpected obstacle on the route.
//
//   topogeo_arrival [--runs 200] [--wheels mild|b21] [--unknown-start] [--jobs 2]
//   topogeo_arrival --floor NAME --run N [--picture FILE.png] [--trace FILE.csv]
#include <cstdio>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

#include "arrival_picture.hpp"
#include "arrival_run.hpp"
#include "arrival_table.hpp"
#include "navigation_floors.hpp"
#include "parallel_drives.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

struct Arguments {
  std::uint64_t runs = 200;
  std::uint64_t first_run = 1;
  std::string wheels = "mild";
  bool unknown_start = false;
  unsigned jobs = 2;
  std::string floor;
  std::optional<std::uint64_t> run;
  std::string picture;
  std::string trace;
  std::string pictures;
  bool verbose = false;
  double slip_per_m = 0.2;
};

void declare(command_line::Command& app, Arguments& arguments) {
  app.add_option("--runs", arguments.runs, "drives, dealt out to the floors by turns")
      ->capture_default_str();
  app.add_option("--first-run", arguments.first_run, "number and seed of the first one")
      ->capture_default_str();
  app.add_option("--wheels", arguments.wheels, "how they err, see simulator --odometry")
      ->check(command_line::one_of({"mild", "b21"}))
      ->capture_default_str();
  app.add_option("--slip", arguments.slip_per_m, "slippery places in a metre")
      ->check(command_line::range(0.0, 10.0))
      ->capture_default_str();
  app.add_flag("--unknown-start", arguments.unknown_start,
               "nobody tells where the robot is: it searches, and may look around");
  app.add_option("--jobs", arguments.jobs, "drives at a time; changes no result")
      ->check(command_line::range(1, 64))
      ->capture_default_str();
  app.add_option("--floor", arguments.floor, "this floor only");
  app.add_option("--run", arguments.run, "this drive only");
  app.add_option("--picture", arguments.picture, "of the drive of --run, PNG");
  app.add_option("--trace", arguments.trace, "of the drive of --run, CSV");
  app.add_option("--pictures", arguments.pictures,
                 "directory for a picture of each drive that did not end well");
  app.add_flag("--verbose", arguments.verbose, "one line for each drive as it ends");
}

struct Job {
  std::string floor;
  std::uint64_t run = 0;
};

std::vector<Job> jobs_of(const Arguments& arguments) {
  std::vector<Job> jobs;
  const std::uint64_t first = arguments.run.value_or(arguments.first_run);
  const std::uint64_t count = arguments.run ? 1 : arguments.runs;
  for (std::uint64_t run = first; run < first + count; ++run) {
    const std::string turn(bench::kNavigationFloors.at(run % bench::kNavigationFloors.size()));
    jobs.push_back({arguments.floor.empty() ? turn : arguments.floor, run});
  }
  return jobs;
}

using Floors = std::map<std::string, bench::MappedFloor>;

Floors map_floors(const std::vector<Job>& jobs, const bench::ArrivalConfig& config) {
  constexpr std::uint64_t kSeed = 7;
  Floors floors;
  for (const Job& job : jobs) {
    if (floors.contains(job.floor)) continue;
    const bench::MappedFloor& floor =
        floors.emplace(job.floor, bench::map_floor(job.floor, config.system, config.wheels, kSeed))
            .first->second;
    std::fprintf(stderr, "%s: tour of %.0f m, %zu stops, %zu zones, %zu border nodes, %.1f s\n",
                 job.floor.c_str(), floor.tour_m, floor.stored->maps.size(),
                 floor.map->zones().zones.size(), floor.map->nodes().size(), floor.seconds);
  }
  return floors;
}

bench::ArrivalRow drive(const Job& job, const bench::MappedFloor& floor,
                        const bench::ArrivalConfig& config, const Arguments& arguments) {
  const bench::ArrivalTask task = bench::draw_task(floor, config, job.run);
  bench::ArrivalRecord record;
  const double begin_s = support::monotonic_s();
  const bench::ArrivalResult result = bench::run_arrival(floor, config, task, &record);
  const std::string title = fmt::format(
      "{}, run {}: {}{}, {:.1f} cm, {:.1f} degrees off, {:.0f} s of {:.1f} m, {} routes, {}",
      job.floor, job.run, result.good() ? "good" : "NOT GOOD",
      task.obstacle == bench::ObstacleKind::kNone
          ? ""
          : fmt::format(", {}{}", to_string(task.obstacle), task.appears ? " appears" : ""),
      100.0 * result.error_m, result.heading_error_rad * 57.29578, result.time_s,
      task.route_length_m, result.plans, result.end);
  if (arguments.verbose) {
    std::fprintf(stderr, "%s (%.1f s)\n", title.c_str(), support::monotonic_s() - begin_s);
  }
  if (!arguments.picture.empty() && arguments.run) {
    bench::write_arrival_picture(arguments.picture, floor, task, record, title);
  }
  if (!arguments.trace.empty() && arguments.run) bench::write_trace(arguments.trace, floor, record);
  if (!arguments.pictures.empty() && !result.good()) {
    bench::write_arrival_picture(arguments.pictures + fmt::format("/{}_{}.png", job.floor, job.run),
                                 floor, task, record, title);
  }
  return {job.floor, job.run, task.obstacle, result};
}

std::vector<bench::ArrivalRow> drive_all(const std::vector<Job>& jobs, const Floors& floors,
                                         const bench::ArrivalConfig& config,
                                         const Arguments& arguments) {
  return bench::drive_in_parallel<bench::ArrivalRow>(jobs, arguments.jobs, [&](const Job& job) {
    return drive(job, floors.at(job.floor), config, arguments);
  });
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("Does a robot get where it is sent?");
  Arguments arguments;
  declare(app, arguments);
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    bench::ArrivalConfig config;
    config.wheels = arguments.wheels == "b21" ? bench::Wheels::kB21 : bench::Wheels::kMild;
    config.slip_per_m = arguments.slip_per_m;
    config.pose_given = !arguments.unknown_start;
    const std::vector<Job> jobs = jobs_of(arguments);
    const double begin_s = support::monotonic_s();
    const Floors floors = map_floors(jobs, config);
    const std::string table = bench::arrival_table(drive_all(jobs, floors, config, arguments));
    std::printf("%s", table.c_str());
    std::fprintf(stderr, "%.0f s, of CPU %.0f s\n", support::monotonic_s() - begin_s,
                 support::process_cpu_s());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_arrival: %s\n", error.what());
    return 1;
  }
  return 0;
}
