// Whether the live pose of a robot in bare corridors is as uncertain as it says.
//
//   topogeo_corridors [--drives N] [--first-seed S] [--verbose]
//
// Each drive draws a corridor without doors (5 to 60 m long, 1.5 to 3 m wide, shut at both ends), a
// laser (4 to 30 m, 180 to 360 degrees) and odometry with the errors of a B21, and drives there and
// back. A first drive makes the map, a second one with other errors is localized in it, from its
// true start. After each scan the error of the live pose along the corridor is compared with the
// standard deviation that the pose states. While the robot maps, the error is relative to the
// start, but under TRACKING relative to the last stop: the state is about the last views. In the
// finished map the truth is relative to the nearest stop of the map. Scans of one drive share their
// errors, so the table also counts whole drives.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/random.hpp"

namespace {

using namespace topogeo;
using geometry::Pose2;
using localization::LocalizationState;

struct Corridor {
  double length_m = 0.0;
  double width_m = 0.0;
  double range_m = 0.0;  ///< of the laser
  double view_rad = 0.0;

  /// Whether the laser sees neither end from the middle.
  [[nodiscard]] bool hides_its_ends() const { return range_m < 0.5 * length_m; }
};

Corridor corridor_of(support::Random& random) {
  const auto between = [&](double least, double most) {
    return least + (most - least) * random.uniform();
  };
  constexpr std::array<double, 3> kViews_deg{180.0, 270.0, 359.0};
  return {between(5.0, 60.0), between(1.5, 3.0), between(4.0, 30.0),
          kViews_deg.at(random.below(kViews_deg.size())) * std::numbers::pi / 180.0};
}

world::World world_of(const Corridor& corridor) {
  const double half_m = 0.5 * corridor.width_m;
  const double length_m = corridor.length_m;
  world::World world;
  world.segments = {{{0.0, -half_m}, {length_m, -half_m}},
                    {{length_m, -half_m}, {length_m, half_m}},
                    {{length_m, half_m}, {0.0, half_m}},
                    {{0.0, half_m}, {0.0, -half_m}}};
  const double end_m = length_m - 1.0;
  world.tour_m = {{1.0, 0.0}, {end_m, 0.0}, {1.0, 0.1}};
  return world;
}

simulation::SimulationOptions options_of(const Corridor& corridor, std::uint64_t seed) {
  simulation::SimulationOptions options;
  options.seed = seed;
  options.scan_step_m = 0.15;
  options.odometry = simulation::b21_odometry(seed);
  options.beams.range_max_m = corridor.range_m;
  options.beams.angle_min_rad = -0.5 * corridor.view_rad;
  options.beams.count =
      1 + static_cast<std::size_t>(corridor.view_rad / options.beams.angle_step_rad);
  return options;
}

/// Errors along the corridor of the live poses of one drive, or of several.
struct Errors {
  std::size_t scans = 0;
  std::size_t within = 0;           ///< two standard deviations
  std::size_t tracking = 0;         ///< while the state was TRACKING
  double sum_m2 = 0.0;              ///< of squared errors
  double largest_tracking_m = 0.0;  ///< while the state was TRACKING
  double sum_sigma_m = 0.0;

  /// `tracking_error_m` counts while the state is TRACKING.
  void add(double error_m, double sigma_m, LocalizationState state, double tracking_error_m) {
    ++scans;
    within += std::abs(error_m) <= 2.0 * sigma_m ? 1 : 0;
    sum_m2 += error_m * error_m;
    sum_sigma_m += sigma_m;
    if (state != LocalizationState::kTracking) return;
    ++tracking;
    largest_tracking_m = std::max(largest_tracking_m, std::abs(tracking_error_m));
  }
  [[nodiscard]] double share(std::size_t count) const {
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, scans));
  }
};

/// Makes the stops of a log, follows the robot by them, and gives its live pose at each scan.
class LiveRobot {
 public:
  LiveRobot(const pipeline::Config& config, const localization::MapToUse* map)
      : config_(config), mapper_(config.local_mapper, "robot") {
    if (map == nullptr) {
      slam_.emplace(config.localizer, pool_);
    } else {
      slam_.emplace(config.localizer, pool_, nullptr, *map);
    }
  }

  void add(const scan::Scan& scan) {
    if (std::optional<topomap::LocalMap> map = mapper_.add(scan)) {
      stops_.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
      (*slam_)->add(stops_.back());
    }
    T_odom_robot_ = scan.T_odom_robot;
  }

  [[nodiscard]] topomap::StopPose last_stop() const { return (*slam_)->last_stop().value(); }
  [[nodiscard]] localization::UncertainPose live_pose() const {
    const topomap::StopPose stop = last_stop();
    return localization::live_pose({stop.T_map_robot, stop.covariance}, stops_.back()->T_odom_robot,
                                   mapper_.last_tracked(), T_odom_robot_,
                                   config_.localizer.odometry);
  }
  [[nodiscard]] LocalizationState state() const { return (*slam_)->status().state; }
  [[nodiscard]] const std::vector<std::shared_ptr<const topomap::LocalMap>>& stops() const {
    return stops_;
  }
  localization::SlamSession& slam() { return *slam_; }

 private:
  pipeline::Config config_;
  pipeline::LocalMapper mapper_;
  localization::InProcessPool pool_;
  std::optional<localization::SlamSession> slam_;
  std::vector<std::shared_ptr<const topomap::LocalMap>> stops_;
  Pose2 T_odom_robot_;
};

/// The direction of the corridor, x of the world, in the frame of the map.
Eigen::Vector2d along_corridor(const Pose2& T_world_map) {
  return {std::cos(T_world_map.theta_rad), -std::sin(T_world_map.theta_rad)};
}

double sigma_along(const localization::UncertainPose& pose, const Eigen::Vector2d& along) {
  return std::sqrt(along.dot(pose.covariance.topLeftCorner<2, 2>() * along));
}

/// A map with the true poses of its stops.
struct MappedCorridor {
  std::shared_ptr<localization::StoredMap> map = std::make_shared<localization::StoredMap>();
  std::vector<Pose2> T_world_stop;

  /// The error along the corridor of a pose in the map, by the stop that makes it smallest among
  /// those within a metre: the map may show a place twice, on the way there and on the way back.
  [[nodiscard]] double error_m(const Pose2& T_map_robot, const Pose2& T_world_robot,
                               const Eigen::Vector2d& along) const {
    constexpr double kNear_m = 1.0;
    double least_m = 1e9;
    for (std::size_t i = 0; i < T_world_stop.size(); ++i) {
      if (std::abs(T_world_stop[i].x_m - T_world_robot.x_m) > kNear_m) continue;
      const Pose2 T_map_truth =
          map->trajectory.stops[i].T_map_robot * geometry::between(T_world_stop[i], T_world_robot);
      const double off_m = along.dot(T_map_robot.position_m() - T_map_truth.position_m());
      if (std::abs(off_m) < std::abs(least_m)) least_m = off_m;
    }
    return least_m;
  }
};

MappedCorridor map_corridor(const simulation::SimulatedLog& log, Errors& errors) {
  LiveRobot robot(pipeline::Config{}, nullptr);
  const Pose2& T_world_map = log.T_world_robot.front();
  const Eigen::Vector2d along = along_corridor(T_world_map);
  MappedCorridor corridor;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    robot.add(log.scans[i]);
    if (corridor.T_world_stop.size() < robot.stops().size()) {
      corridor.T_world_stop.push_back(log.T_world_robot[i]);
    }
    const localization::UncertainPose live = robot.live_pose();
    const auto error_m = [&](const Pose2& T_map_robot, const Pose2& T_world_robot) {
      return (T_world_map * T_map_robot).x_m - T_world_robot.x_m;
    };
    const double from_start_m = error_m(live.T_a_b, log.T_world_robot[i]);
    const double of_stop_m = error_m(robot.last_stop().T_map_robot, corridor.T_world_stop.back());
    errors.add(from_start_m, sigma_along(live, along), robot.state(), from_start_m - of_stop_m);
  }
  robot.slam()->finish();
  for (const auto& stop : robot.stops()) corridor.map->maps.push_back(*stop);
  corridor.map->trajectory = robot.slam()->trajectory();
  return corridor;
}

void localize(const MappedCorridor& corridor, const simulation::SimulatedLog& log, Errors& errors) {
  const Pose2 T_map_start =
      corridor.map->trajectory.stops.front().T_map_robot *
      geometry::between(corridor.T_world_stop.front(), log.T_world_robot.front());
  const localization::MapToUse use{corridor.map, localization::MapToUse::Use::kLocalize,
                                   T_map_start};
  LiveRobot robot(pipeline::Config{}, &use);
  const Eigen::Vector2d along = along_corridor(corridor.T_world_stop.front());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    robot.add(log.scans[i]);
    const localization::UncertainPose live = robot.live_pose();
    const double error_m = corridor.error_m(live.T_a_b, log.T_world_robot[i], along);
    errors.add(error_m, sigma_along(live, along), robot.state(), error_m);
  }
}

/// The drives of a row of the table.
struct CorridorRow {
  const char* name;
  std::vector<Errors> drives{};
};

void print(const char* name, const std::vector<Errors>& drives) {
  Errors all;
  std::size_t honest = 0;
  for (const Errors& drive : drives) {
    all.scans += drive.scans;
    all.within += drive.within;
    all.tracking += drive.tracking;
    all.sum_m2 += drive.sum_m2;
    all.sum_sigma_m += drive.sum_sigma_m;
    all.largest_tracking_m = std::max(all.largest_tracking_m, drive.largest_tracking_m);
    constexpr double kHonest = 0.95;
    honest += drive.share(drive.within) >= kHonest ? 1 : 0;
  }
  const double scans = static_cast<double>(std::max<std::size_t>(1, all.scans));
  std::printf("%-34s %6zu %8.1f %% %6zu of %3zu %8.3f %8.3f %8.1f %% %8.3f\n", name, all.scans,
              100.0 * all.share(all.within), honest, drives.size(), std::sqrt(all.sum_m2 / scans),
              all.sum_sigma_m / scans, 100.0 * all.share(all.tracking), all.largest_tracking_m);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("Live poses along bare corridors, and what they state");
  std::uint64_t drives = 200;
  std::uint64_t first_seed = 1;
  bool verbose = false;
  app.add_option("--drives", drives)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_flag("--verbose", verbose, "one line for each drive");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    std::array<CorridorRow, 4> rows{{{"maps, ends seen from the middle"},
                                     {"maps, ends out of range"},
                                     {"finished map, ends seen"},
                                     {"finished map, ends out of range"}}};
    for (std::uint64_t seed = first_seed; seed < first_seed + drives; ++seed) {
      support::Random random(seed);
      const Corridor corridor = corridor_of(random);
      const std::size_t hidden = corridor.hides_its_ends() ? 1 : 0;
      const world::World world = world_of(corridor);
      constexpr std::uint64_t kOtherErrors = 1'000'000;
      Errors mapping;
      Errors localizing;
      const MappedCorridor mapped =
          map_corridor(simulation::simulate_log(world, options_of(corridor, seed)), mapping);
      localize(mapped, simulation::simulate_log(world, options_of(corridor, seed + kOtherErrors)),
               localizing);
      rows.at(hidden).drives.push_back(mapping);
      rows.at(2 + hidden).drives.push_back(localizing);
      if (!verbose) continue;
      std::fprintf(stderr, "seed %llu: %.1f x %.1f m, laser %.1f m\n",
                   static_cast<unsigned long long>(seed), corridor.length_m, corridor.width_m,
                   corridor.range_m);
      print("  maps", {mapping});
      print("  in its finished map", {localizing});
    }
    std::printf("%-34s %6s %10s %13s %8s %8s %10s %8s\n", "corridors", "scans", "in 2 sigma",
                "drives >= 95%", "rms m", "sigma m", "TRACKING", "most m");
    for (const CorridorRow& row : rows) print(row.name, row.drives);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_corridors: %s\n", error.what());
    return 1;
  }
  return 0;
}
