// Random drives of a robot that is not round, for tests and topogeo_outline_drives.
#pragma once

#include <numbers>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/simulation/contact.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

#include "test_drive.hpp"

namespace topogeo::navigation {

/// A rectangle around the origin, which is `behind_m` behind its middle.
inline geometry::Footprint rectangle(double length_m, double width_m, double behind_m = 0.0) {
  const double front_m = 0.5 * length_m + behind_m;
  const double back_m = -0.5 * length_m + behind_m;
  const double y_m = 0.5 * width_m;
  return {{{front_m, y_m}, {front_m, -y_m}, {back_m, -y_m}, {back_m, y_m}}};
}

/// How the robot of the drives turns.
struct OutlineBase {
  double radius_m = 0.0;  ///< smallest of its turns; 0: on the spot
  double axle_m = 0.0;    ///< of the axle that does not steer, behind the middle of the body
};

inline constexpr double kLength_m = 1.2;
inline constexpr double kWidth_m = 0.6;

struct OutlineTask {
  geometry::Pose2 T_start;  ///< world and map frame
  geometry::Pose2 T_goal;
  double route_m = 0.0;  ///< length of the route of the planner
  std::uint64_t seed = 0;
  OutlineBase base{};
};

/// Start and goal at least 3 m apart, in any headings, with 0.15 m free around the outline.
inline OutlineTask draw_outline_task(const world::World& floor, std::uint64_t seed,
                                     const OutlineBase& base = {}) {
  constexpr double kLeast_m = 3.0;
  constexpr double kBeside_m = 0.15;
  const auto room = rectangle(kLength_m + 2.0 * kBeside_m, kWidth_m + 2.0 * kBeside_m, base.axle_m);
  const auto map = map_of(floor);
  const planning::FreeSpace& space = map->space();
  const planning::HybridPlanner planner(*map);
  support::Random random(seed * 7919 + 1);
  const auto draw = [&] {
    while (true) {
      const std::size_t index = random.below(space.frame().size());
      const double heading_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
      if (!space.passable(index)) continue;
      const Eigen::Vector2d at_m = space.frame().center_m(space.frame().cell_at(index));
      const geometry::Pose2 pose{at_m.x(), at_m.y(), heading_rad};
      if (!simulation::overlap_m(floor, pose, room)) return pose;
    }
  };
  while (true) {
    OutlineTask task{draw(), draw(), 0.0, seed, base};
    const auto route = planner.plan(task.T_start.position_m(), task.T_goal.position_m());
    task.route_m = route.length_m;
    if (route.found() && route.length_m >= kLeast_m) return task;
  }
}

inline DriveSettings settings_of(const OutlineTask& task) {
  DriveSettings settings;
  settings.T_world_start = task.T_start;
  settings.navigator.guard.footprint = rectangle(kLength_m, kWidth_m, task.base.axle_m);
  settings.navigator.guard.minimum_turning_radius_m = task.base.radius_m;
  settings.noise = true;
  settings.seed = task.seed;
  return settings;
}

}  // namespace topogeo::navigation
