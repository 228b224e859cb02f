// How well are the times of drives known before they begin? Simulated drives on drawn floors
// between random points, each through slow zones, with noise of laser, sonars, wheels and poses, on
// simulated time.
//
//   topogeo_drive_times [--runs 50] [--first-run 1] [--verbose]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/navigation/drive_time.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/support/random.hpp"

#include "navigation/test_drive.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)
using planning::DrawnZone;

constexpr double kMostError = 0.15;

struct Task {
  geometry::Pose2 T_world_start;
  Eigen::Vector2d goal_m = Eigen::Vector2d::Zero();
  std::vector<DrawnZone> zones;
};

struct Times {
  bool arrived = false;
  double estimated_s = 0.0;
  double at_goal_s = 0.0;  ///< until the robot is there; its last corrections depend on the noise
  double arrived_s = 0.0;  ///< until it has checked its position
};

struct Row {
  std::string name;
  world::World world;
  int drives = 0;
  int arrived = 0;
  int within = 0;          ///< of kMostError, until the robot is there
  int within_arrived = 0;  ///< the same until it has checked its position
  double sum = 0.0;        ///< of the relative errors, with their signs
  double worst = 0.0;
  double worst_arrived = 0.0;
  double slow_s = 0.0;  ///< how much longer the zones make the estimates
  double driven_s = 0.0;
};

DrawnZone slow_square(const Eigen::Vector2d& middle_m, support::Random& random) {
  const double half_m = random.uniform(0.4, 1.5);
  DrawnZone zone;
  zone.name = "slow";
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1),
                                        Eigen::Vector2d(1, 1), Eigen::Vector2d(-1, 1)}) {
    zone.polygon_m.emplace_back(middle_m + half_m * corner);
  }
  zone.kind = planning::ZoneKind::kSlow;
  zone.value = random.uniform(0.1, 0.4);
  return zone;
}

/// A route of at least 4 m between free points, with one to three slow zones on it.
Task draw_task(const world::World& world, std::uint64_t seed) {
  constexpr double kLeast_m = 4.0;
  constexpr double kClearance_m = 0.4;
  const auto map = navigation::map_of(world);
  const planning::FreeSpace& space = map->space();
  support::Random random(seed * 104'729 + 3);
  const auto draw = [&]() -> Eigen::Vector2d {
    while (true) {
      const std::size_t index = random.below(space.frame().size());
      Eigen::Vector2d at_m = space.frame().center_m(space.frame().cell_at(index));
      if (space.passable(index) && world::clearance_m(world, at_m) >= kClearance_m) return at_m;
    }
  };
  while (true) {
    const Eigen::Vector2d start_m = draw();
    Task task{{start_m.x(), start_m.y(), random.uniform(-std::numbers::pi, std::numbers::pi)},
              draw(),
              {}};
    const auto route = planning::HybridPlanner(*map).plan(start_m, task.goal_m);
    if (!route.found() || route.length_m < kLeast_m) continue;
    for (std::size_t zones = 1 + random.below(3); zones > 0; --zones) {
      const std::size_t at = random.below(route.points_m.size() - 1);
      const Eigen::Vector2d middle_m =
          route.points_m[at] +
          random.uniform(0.0, 1.0) * (route.points_m[at + 1] - route.points_m[at]);
      task.zones.push_back(slow_square(middle_m, random));
    }
    return task;
  }
}

Times drive(const world::World& world, const Task& task, std::uint64_t seed, Row& row) {
  navigation::DriveSettings settings;
  settings.T_world_start = task.T_world_start;
  settings.noise = true;
  settings.seed = seed;
  navigation::TestDrive drive(world, settings);
  const Eigen::Vector2d start_m = task.T_world_start.position_m();
  const auto estimate_s = [&] {
    const auto route = planning::HybridPlanner(*drive.map).plan(start_m, task.goal_m);
    return navigation::drive_time_s(route.points_m, task.T_world_start.theta_rad,
                                    &drive.map->space(), settings.navigator);
  };
  const double without_s = estimate_s();
  drive.draw(task.zones);
  Times times;
  times.estimated_s = estimate_s();
  row.slow_s += times.estimated_s - without_s;
  drive.go_to(task.goal_m);
  const double begin_s = drive.time_s();
  const auto arrived = [&] { return drive.status().state == navigation::NavigatorState::kArrived; };
  const auto at_goal = [&] {
    return arrived() || drive.status().message.starts_with("at the goal");
  };
  constexpr double kLongest_s = 900.0;
  times.arrived = drive.run_until(at_goal, kLongest_s);
  times.at_goal_s = drive.time_s() - begin_s;
  times.arrived = times.arrived && (arrived() || drive.run_until(arrived, kLongest_s));
  times.arrived_s = drive.time_s() - begin_s;
  return times;
}

void add(Row& row, std::uint64_t run, bool verbose) {
  const Task task = draw_task(row.world, run);
  const Times times = drive(row.world, task, run, row);
  const double error = times.estimated_s / times.at_goal_s - 1.0;
  const double error_arrived = times.estimated_s / times.arrived_s - 1.0;
  ++row.drives;
  if (verbose || !times.arrived || std::fabs(error) > kMostError) {
    std::fprintf(stderr, "%s, run %llu: %s, %.1f s estimated, %.1f s until there, %.1f s in all\n",
                 row.name.c_str(), static_cast<unsigned long long>(run),
                 times.arrived ? "arrived" : "NOT ARRIVED", times.estimated_s, times.at_goal_s,
                 times.arrived_s);
  }
  if (!times.arrived) return;
  ++row.arrived;
  row.within += std::fabs(error) <= kMostError ? 1 : 0;
  row.within_arrived += std::fabs(error_arrived) <= kMostError ? 1 : 0;
  row.sum += error;
  row.worst = std::max(row.worst, std::fabs(error));
  row.worst_arrived = std::max(row.worst_arrived, std::fabs(error_arrived));
  row.driven_s += times.at_goal_s;
}

void print(const Row& row) {
  std::printf("| %s | %d | %d | %.0f | %.0f | %d | %+.1f, %.1f | %d | %.1f |\n", row.name.c_str(),
              row.drives, row.arrived, row.driven_s, row.slow_s, row.within,
              100.0 * row.sum / std::max(1, row.arrived), 100.0 * row.worst, row.within_arrived,
              100.0 * row.worst_arrived);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("How well are the times of drives through slow zones known?");
  std::uint64_t runs = 50;
  std::uint64_t first_run = 1;
  bool verbose = false;
  app.add_option("--runs", runs, "drives, dealt out to the floors by turns")->capture_default_str();
  app.add_option("--first-run", first_run, "number and seed of the first one")
      ->capture_default_str();
  app.add_flag("--verbose", verbose, "one line for each drive as it ends");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    constexpr std::uint64_t kLoopsSeed = 5;
    std::array<Row, 3> rows;
    rows[0] = {"office", world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/floor.world.yaml")};
    rows[1] = {"warehouse", world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/hall.world.yaml")};
    rows[2] = {"two loops", simulation::two_loops(kLoopsSeed)};
    for (std::uint64_t run = first_run; run < first_run + runs; ++run) {
      add(rows.at(run % rows.size()), run, verbose);
    }
    std::printf(
        "| floor | drives | arrived | driven, s | of it for slow zones, s | within 15 %% until "
        "there "
        "| mean, worst error, %% | within 15 %% in all | worst error in all, %% |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    for (const Row& row : rows) print(row);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_drive_times: %s\n", error.what());
    return 1;
  }
  return 0;
}
