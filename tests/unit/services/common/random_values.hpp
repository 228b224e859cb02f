// Random values of every type in messages, with all fields set, and equality to the last bit.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/planning/route_planner.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo {

/// Any finite number: random sign, mantissa and exponent.
inline double any_double(support::Random& random) {
  while (true) {
    const double value = std::bit_cast<double>(random.next_u64());
    if (value - value == 0.0) return value;
  }
}

inline float any_float(support::Random& random) {
  return static_cast<float>(random.uniform(-50.0, 50.0));
}

inline std::uint32_t any_u32(support::Random& random) {
  return static_cast<std::uint32_t>(random.next_u64());
}

inline std::uint16_t any_u16(support::Random& random) {
  return static_cast<std::uint16_t>(random.next_u64());
}

inline std::int64_t any_i64(support::Random& random) {
  return std::bit_cast<std::int64_t>(random.next_u64());
}

inline bool any_bool(support::Random& random) {
  return random.below(2) == 1;
}

inline geometry::Pose2 any_pose(support::Random& random) {
  return {any_double(random), any_double(random), any_double(random)};
}

inline Eigen::Matrix3d any_matrix(support::Random& random) {
  Eigen::Matrix3d out;
  for (double& value : out.reshaped()) value = any_double(random);
  return out;
}

inline topomap::NodeKind any_kind(support::Random& random) {
  return static_cast<topomap::NodeKind>(random.below(6));
}

inline std::vector<topomap::BranchPoint> any_points(support::Random& random) {
  std::vector<topomap::BranchPoint> out(2 + random.below(20));
  for (auto& p : out) p = {{any_double(random), any_double(random)}, any_double(random)};
  return out;
}

inline scan::Scan any_scan(support::Random& random) {
  scan::Scan out;
  out.sequence = random.next_u64();
  out.stamp_ns = any_i64(random);
  out.angle_min_rad = any_double(random);
  out.angle_step_rad = random.uniform(1e-3, 1.0);
  for (int i = 0; i < 361; ++i) {
    out.ranges_m.push_back(static_cast<float>(random.uniform(0.0, 80.0)));
  }
  out.T_odom_robot = any_pose(random);
  return out;
}

inline topomap::LocalMap any_local_map(support::Random& random) {
  topomap::LocalMap out;
  out.robot_id = "robot";
  out.id = any_u32(random);
  out.stop = {0x0123456789abcdefULL, out.id};
  out.odometry_epoch = 17;
  out.sequence = random.next_u64();
  out.stamp_ns = any_i64(random);
  out.T_odom_robot = any_pose(random);
  out.T_previous_robot = any_pose(random);
  out.T_robot_laser = any_pose(random);
  for (std::uint32_t i = 0; i < 20; ++i) {
    topomap::LocalNode node{
        i,  any_kind(random), {any_double(random), any_double(random)}, any_double(random),
        {}, any_bool(random)};
    node.base_groups.resize(random.below(5));
    for (auto& group : node.base_groups) group = any_u16(random);
    out.nodes.push_back(node);
  }
  for (std::uint32_t i = 0; i < 30; ++i) {
    out.branches.push_back({i,
                            static_cast<std::uint32_t>(random.below(20)),
                            static_cast<std::uint32_t>(random.below(20)),
                            {any_u16(random), any_u16(random)},
                            any_bool(random),
                            any_bool(random),
                            any_bool(random),
                            any_points(random)});
  }
  for (int i = 0; i < 100; ++i) out.points.push_back({any_float(random), any_float(random)});
  for (int i = 0; i < 5; ++i) {
    out.track.push_back(
        {random.next_u64(), any_i64(random), any_pose(random), any_pose(random), any_bool(random)});
  }
  return out;
}

inline topomap::Trajectory any_trajectory(support::Random& random, std::uint32_t stops) {
  topomap::Trajectory out;
  out.version = random.next_u64();
  for (std::uint32_t i = 0; i < stops; ++i) {
    out.stops.push_back({i,
                         any_i64(random),
                         any_pose(random),
                         any_matrix(random),
                         {random.next_u64(), any_u32(random)},
                         random.next_u64() % 2 == 0,
                         1 + static_cast<std::uint32_t>(random.below(9)),
                         any_i64(random)});
  }
  return out;
}

inline topomap::GlobalMap any_global_map(support::Random& random) {
  topomap::GlobalMap out;
  out.version = random.next_u64();
  for (std::uint32_t i = 0; i < 20; ++i) {
    out.nodes.push_back({3 * i,
                         any_kind(random),
                         {any_double(random), any_double(random)},
                         any_double(random),
                         any_u32(random),
                         any_i64(random)});
  }
  for (std::uint32_t i = 0; i < 30; ++i) {
    out.branches.push_back({2 * i, 3 * static_cast<std::uint32_t>(random.below(20)),
                            3 * static_cast<std::uint32_t>(random.below(20)), any_bool(random),
                            any_u32(random), any_points(random), any_i64(random)});
  }
  return out;
}

}  // namespace topogeo

// Equality for types that lack it, for tests only.
namespace topogeo::topomap {

inline bool operator==(const BranchPoint& a, const BranchPoint& b) {
  return a.position_m == b.position_m && a.clearance_m == b.clearance_m;
}
inline bool operator==(const LocalNode& a, const LocalNode& b) {
  return a.id == b.id && a.kind == b.kind && a.position_m == b.position_m &&
         a.clearance_m == b.clearance_m && a.base_groups == b.base_groups &&
         a.in_main_graph == b.in_main_graph;
}
inline bool operator==(const LocalBranch& a, const LocalBranch& b) {
  return a.id == b.id && a.node_a == b.node_a && a.node_b == b.node_b &&
         a.base_groups == b.base_groups && a.is_virtual == b.is_virtual &&
         a.in_main_graph == b.in_main_graph && a.confirmed == b.confirmed && a.points == b.points;
}
inline bool operator==(const ScanPoint& a, const ScanPoint& b) {
  return a.x_m == b.x_m && a.y_m == b.y_m;
}
inline bool operator==(const TrackedScan& a, const TrackedScan& b) {
  return a.sequence == b.sequence && a.stamp_ns == b.stamp_ns && a.T_odom_robot == b.T_odom_robot &&
         a.T_stop_robot == b.T_stop_robot && a.matched == b.matched;
}
inline bool operator==(const LocalMap& a, const LocalMap& b) {
  return a.robot_id == b.robot_id && a.id == b.id && a.stop == b.stop && a.sequence == b.sequence &&
         a.odometry_epoch == b.odometry_epoch && a.stamp_ns == b.stamp_ns &&
         a.T_odom_robot == b.T_odom_robot && a.T_previous_robot == b.T_previous_robot &&
         a.T_robot_laser == b.T_robot_laser && a.nodes == b.nodes && a.branches == b.branches &&
         a.points == b.points && a.track == b.track && a.starts_drive == b.starts_drive;
}
inline bool operator==(const StopPose& a, const StopPose& b) {
  return a.local_map_id == b.local_map_id && a.stamp_ns == b.stamp_ns &&
         a.T_map_robot == b.T_map_robot && a.covariance == b.covariance && a.stop == b.stop &&
         a.located == b.located && a.views == b.views && a.last_view_ns == b.last_view_ns;
}
inline bool operator==(const Trajectory& a, const Trajectory& b) {
  return a.version == b.version && a.stops == b.stops && a.numbered_since == b.numbered_since;
}
inline bool operator==(const LoopClosure& a, const LoopClosure& b) {
  return a.earlier_id == b.earlier_id && a.later_id == b.later_id &&
         a.T_earlier_later == b.T_earlier_later;
}
inline bool operator==(const MapNode& a, const MapNode& b) {
  return a.id == b.id && a.kind == b.kind && a.position_m == b.position_m &&
         a.clearance_m == b.clearance_m && a.observations == b.observations &&
         a.last_seen_ns == b.last_seen_ns;
}
inline bool operator==(const MapBranch& a, const MapBranch& b) {
  return a.id == b.id && a.node_a == b.node_a && a.node_b == b.node_b &&
         a.is_virtual == b.is_virtual && a.observations == b.observations && a.points == b.points &&
         a.last_seen_ns == b.last_seen_ns;
}
inline bool operator==(const GlobalMap& a, const GlobalMap& b) {
  return a.version == b.version && a.nodes == b.nodes && a.branches == b.branches;
}

}  // namespace topogeo::topomap
