// Noiseless scans of worlds made of a few lines, and hand-made branch samples.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization::test {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A laser's part of a circle; beams from `first_deg`, in steps, to `last_deg`.
struct Sweep {
  double first_deg = -180.0;
  double last_deg = 179.5;
  double step_deg = 0.5;
  double range_m = 8.0;
};

/// Exact points of a world from a pose, in the frame of the robot, whose laser is at its origin.
inline std::vector<topomap::ScanPoint> exact_points(const world::World& world,
                                                    const geometry::Pose2& T_world_robot,
                                                    const Sweep& sweep = {}) {
  simulation::BeamPattern beams;
  beams.angle_min_rad = sweep.first_deg * kDegree;
  beams.angle_step_rad = sweep.step_deg * kDegree;
  beams.count =
      static_cast<std::size_t>(std::lround((sweep.last_deg - sweep.first_deg) / sweep.step_deg)) +
      1;
  beams.range_max_m = sweep.range_m;
  const std::vector<double> ranges_m = simulation::raycast(world, T_world_robot, beams);
  std::vector<topomap::ScanPoint> points;
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    if (!std::isfinite(ranges_m[i])) continue;
    const double angle_rad = beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad;
    points.push_back({static_cast<float>(ranges_m[i] * std::cos(angle_rad)),
                      static_cast<float>(ranges_m[i] * std::sin(angle_rad))});
  }
  return points;
}

inline world::World lines(std::vector<world::Segment> segments) {
  world::World world;
  world.segments = std::move(segments);
  return world;
}

/// A room with a recess, so that no two of its poses look alike; the origin is inside.
///
///   (-2,3)-------------(4,3)
///     |                  |
///     |        (2,0)--(4,0)
///     |          |
///   (-2,-2)---(2,-2)
inline world::World l_room() {
  return lines({{{-2, -2}, {2, -2}},
                {{2, -2}, {2, 0}},
                {{2, 0}, {4, 0}},
                {{4, 0}, {4, 3}},
                {{4, 3}, {-2, 3}},
                {{-2, 3}, {-2, -2}}});
}

/// Two walls along x at y = -1 and y = 1, longer than the laser sees.
inline world::World endless_corridor() {
  return lines({{{-40, -1}, {40, -1}}, {{-40, 1}, {40, 1}}});
}

/// The same corridor with a shut door 0.9 m wide in its left wall, set back by 0.08 m, from x = 2.
inline world::World corridor_with_shut_door() {
  return lines({{{-40, -1}, {40, -1}},
                {{-40, 1}, {2, 1}},
                {{2, 1}, {2, 1.08}},
                {{2, 1.08}, {2.9, 1.08}},
                {{2.9, 1.08}, {2.9, 1}},
                {{2.9, 1}, {40, 1}}});
}

inline MatchFeatures features_at(const world::World& world, const geometry::Pose2& T_world_robot,
                                 const Sweep& sweep = {}) {
  return extract_scan_features(exact_points(world, T_world_robot, sweep), {});
}

inline BranchSample sample(double x_m, double y_m, double direction_rad, double clearance_m) {
  return {{x_m, y_m}, {std::cos(direction_rad), std::sin(direction_rad)}, clearance_m};
}

inline topomap::LocalNode node(double x_m, double y_m, double clearance_m,
                               topomap::NodeKind kind = topomap::NodeKind::kReal) {
  topomap::LocalNode node;
  node.kind = kind;
  node.position_m = {x_m, y_m};
  node.clearance_m = clearance_m;
  return node;
}

inline double distance_m(const geometry::Pose2& a, const geometry::Pose2& b) {
  return (a.position_m() - b.position_m()).norm();
}

inline double turn_rad(const geometry::Pose2& a, const geometry::Pose2& b) {
  return std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad));
}

}  // namespace topogeo::localization::test
