// The local topo-geometric map made at one stop of the robot (Thesis, 5.2.3).
//
// Coordinates are in the robot frame at the stop (x forward, y left), metres. All elements are
// kept: those off the main graph serve matching, the main graph serves navigation
// (`in_main_graph`).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::topomap {

enum class NodeKind : std::uint8_t {
  kReal = 0,          ///< three or more generator groups equally near, proved by the scan
  kFictitious = 1,    ///< end of the known part of a branch; no place of its own
  kVirtual = 2,       ///< of a virtual diagram; for navigation only
  kDoor = 3,          ///< minimum of clearance up to door_half_width
  kNarrowing = 4,     ///< any other minimum of clearance
  kHallCorridor = 5,  ///< change from one plateau of clearance to another
};

struct LocalNode {
  std::uint32_t id = 0;  ///< index in LocalMap::nodes
  NodeKind kind = NodeKind::kReal;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double clearance_m = 0.0;                ///< distance to the base groups
  std::vector<std::uint16_t> base_groups;  ///< generator groups equally near, ascending
  bool in_main_graph = true;
};

struct BranchPoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double clearance_m = 0.0;
};

struct LocalBranch {
  std::uint32_t id = 0;      ///< index in LocalMap::branches
  std::uint32_t node_a = 0;  ///< node at points.front()
  std::uint32_t node_b = 0;  ///< node at points.back()
  std::array<std::uint16_t, 2> base_groups{};
  bool is_virtual = false;
  bool in_main_graph = true;
  bool confirmed = true;  ///< the clearance circles of its points were seen; otherwise unseen
                          ///< objects can move it
  std::vector<BranchPoint> points;  ///< ordered from node_a to node_b, at least two
};

/// A scan point kept for matching.
struct ScanPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
};

/// A scan taken between the previous stop and this one, located relative to the previous stop.
struct TrackedScan {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_odom_robot;
  geometry::Pose2 T_stop_robot;  ///< in the frame of the previous stop
  bool matched = false;          ///< false: T_stop_robot is by odometry only
};

/// Origin of a stop, which never changes, whatever map it joins. In a session one local mapper
/// numbers the stops of one robot.
struct StopId {
  std::uint64_t session = 0;
  std::uint32_t number = 0;  ///< counts the stops of the session from 0
  [[nodiscard]] StopId next() const { return {session, number + 1}; }
  friend auto operator<=>(const StopId&, const StopId&) = default;
};

struct LocalMap {
  std::string robot_id;
  std::uint32_t id = 0;  ///< number of the stop in its map or, outside a map, in its session
  StopId stop{};
  std::uint64_t sequence = 0;  ///< of the scan taken at the stop
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_odom_robot;      ///< odometry at the stop
  std::uint64_t odometry_epoch = 0;  ///< of T_odom_robot, as in scan::Scan
  geometry::Pose2 T_previous_robot;  ///< pose in the frame of the previous stop by scan tracking;
                                     ///< identity for id 0
  geometry::Pose2 T_robot_laser;     ///< mounting of the laser
  std::vector<LocalNode> nodes;
  std::vector<LocalBranch> branches;
  std::vector<ScanPoint> points;   ///< of the stop's scan, in beam order, within the range limit
  std::vector<TrackedScan> track;  ///< scans between the previous stop and this one, in time order
  /// In a map of several drives: the first stop of a later drive. Neither odometry nor `track`
  /// connects it with the previous stop.
  bool starts_drive = false;
};

/// 64-bit FNV-1a hash of everything that a match can depend on (id, points, nodes, branches,
/// mounting), so that a worker can check that it holds the map that a task names.
std::uint64_t content_hash(const LocalMap& map);
/// The hash of the map with this id.
std::uint64_t content_hash(const LocalMap& map, std::uint32_t id);

/// Whether the odometry of two successive stops has one origin, so that it measures the step: both
/// are of one drive, and the odometry did not restart between them.
bool has_odometry_between(const LocalMap& before, const LocalMap& after);

/// The map as stop number `id` in a map of several drives; `starts_drive`: the first stop of a
/// later drive.
LocalMap numbered(LocalMap map, std::uint32_t id, bool starts_drive);

}  // namespace topogeo::topomap
