// Conversions between messages and library types, exact to the last bit.
//
// to_msg throws std::invalid_argument naming the field when a value does not fit its bound.
// from_msg throws it when the message contradicts itself (a node that does not exist, a number that
// is not finite), so its result is safe to use. Fields without a counterpart in the library types
// (robot, stamp, sequence number, addresses) are arguments of to_msg.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/map_update.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::map_client {
struct Map;
}

namespace topogeo::service {

msg::Pose2 to_msg(const geometry::Pose2& pose);
geometry::Pose2 from_msg(const msg::Pose2& pose);

msg::Matrix3 to_msg(const Eigen::Matrix3d& matrix);
Eigen::Matrix3d from_msg(const msg::Matrix3& matrix);

msg::Scan to_msg(const scan::Scan& scan, std::string_view robot_id);
/// Rejects ranges that are negative, infinite or NaN and beams that do not ascend.
scan::Scan from_msg(const msg::Scan& message);

msg::StopId to_msg(const topomap::StopId& stop);
topomap::StopId from_msg(const msg::StopId& stop);

/// Fills content_hash.
msg::LocalMap to_msg(const topomap::LocalMap& map);
/// Converts everything but content_hash, which is not checked.
topomap::LocalMap content_from_msg(const msg::LocalMap& message);
/// Checks content_hash as well.
topomap::LocalMap from_msg(const msg::LocalMap& message);

/// Client and worker of a match exchange, and the versions that both must agree on.
struct MatchAddress {
  std::string robot_id;
  std::int64_t stamp_ns = 0;  ///< of the first task's query map
  std::uint64_t sequence_number = 0;
  std::string worker_id;
  std::string client_id;
  std::string version;                    ///< of tasks
  std::uint64_t config_fingerprint = 0;   ///< of tasks
  std::uint64_t matcher_fingerprint = 0;  ///< of tasks
};

/// Messages without a task, and without a result.
msg::MatchTasks tasks_for(const MatchAddress& address);
msg::MatchResults results_for(const MatchAddress& address);

/// `stamp_ns` is the stamp of the query map's scan.
msg::MatchTask to_msg(const localization::MatchTask& task, std::int64_t stamp_ns);
localization::MatchTask from_msg(const msg::MatchTask& message);

msg::MatchResult to_msg(const localization::MatchResult& result);
/// Throws for a refused task as well: check status() first.
localization::MatchResult from_msg(const msg::MatchResult& message);

/// Number of segments of a trajectory with `stops` stops.
std::uint32_t segment_count(std::size_t stops);
/// Segment `segment` < segment_count of the trajectory.
msg::TrajectorySegment to_segment(const topomap::Trajectory& trajectory, std::uint32_t segment,
                                  std::string_view robot_id, std::uint64_t sequence_number);
/// All segments in order, numbered from `first_sequence_number`.
std::vector<msg::TrajectorySegment> to_segments(const topomap::Trajectory& trajectory,
                                                std::string_view robot_id,
                                                std::uint64_t first_sequence_number);
/// The stops of one segment, checked: consecutive ids from 256 * segment on.
std::vector<topomap::StopPose> from_msg(const msg::TrajectorySegment& message);

msg::LoopClosures to_msg(std::span<const topomap::LoopClosure> closures,
                         std::uint64_t trajectory_version, std::string_view robot_id,
                         std::int64_t stamp_ns, std::uint64_t sequence_number,
                         std::uint64_t numbered_since = 0);
std::vector<topomap::LoopClosure> from_msg(const msg::LoopClosures& message);

/// Number of segments for `edges` measurements: at least one.
std::uint32_t edge_segment_count(std::size_t edges);
/// Segment `segment` < edge_segment_count of the measurements behind a trajectory.
msg::MapEdges to_segment(std::span<const storage::MapEdge> edges, std::uint32_t segment,
                         std::uint64_t trajectory_version, std::string_view robot_id,
                         std::int64_t stamp_ns, std::uint64_t sequence_number,
                         std::uint64_t numbered_since = 0);
/// The measurements of one segment, checked: as many as `total` implies, with ascending stops.
std::vector<storage::MapEdge> from_msg(const msg::MapEdges& message);

/// Number of segments for this number of loop decisions.
std::uint32_t decision_segment_count(std::size_t decisions);
/// Segment `segment` < decision_segment_count of all decisions so far.
msg::LoopDecisions to_segment(std::span<const localization::LoopDecision> decisions,
                              std::uint32_t segment, std::string_view robot_id,
                              std::int64_t stamp_ns, std::uint64_t sequence_number,
                              std::uint64_t numbered_since = 0);
/// The decisions of one segment, checked: as many as `total` implies.
std::vector<localization::LoopDecision> from_msg(const msg::LoopDecisions& message);

/// A command to the localizer, as in msg::LocalizationCommand.
struct LocalizationCommand {
  std::uint64_t request_id = 0;
  std::string client_id;
  msg::LocalizationCommandKind kind = msg::kCommandSearch;
  geometry::Pose2 T_map_robot;                           ///< kCommandSetPose
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< the same; in the map frame
};

msg::LocalizationCommand to_msg(const LocalizationCommand& command, std::string_view robot_id,
                                std::int64_t stamp_ns, std::uint64_t sequence_number);
/// Rejects the covariance of a pose to set unless it is symmetric and positive definite.
LocalizationCommand from_msg(const msg::LocalizationCommand& message);

/// A scan tracked against that stop.
msg::TrackedPose to_msg(const topomap::TrackedScan& scan, const topomap::StopId& stop,
                        std::string_view robot_id);
/// The scan alone.
topomap::TrackedScan from_msg(const msg::TrackedPose& message);

/// Current pose of the robot, as in msg::LivePose.
struct LivePose {
  std::int64_t stamp_ns = 0;   ///< of the scan
  std::uint64_t sequence = 0;  ///< of the scan
  localization::LocalizationStatus status;
  msg::LocalizerMode mode = msg::kModeMapping;
  geometry::Pose2 T_map_robot;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  topomap::StopId last_stop;
  std::uint64_t trajectory_version = 0;  ///< that the pose belongs to
};

msg::LivePose to_msg(const LivePose& pose, std::string_view robot_id);
LivePose from_msg(const msg::LivePose& message);

/// Nodes, branches and last the summary, each with map_version of the map and sequence number 0,
/// and no hash of samples.
std::vector<msg::MapElement> to_elements(const topomap::GlobalMap& map, std::uint64_t map_id,
                                         std::string_view robot_id, std::int64_t stamp_ns);
topomap::MapNode node_from_msg(const msg::MapElement& message);
topomap::MapBranch branch_from_msg(const msg::MapElement& message);
/// Throws like node_from_msg and branch_from_msg, and when a branch ends at a missing node.
topomap::GlobalMap from_elements(const map_client::Map& map);

/// A destination for the robot, or a command about its current goal, as in msg::Goal.
struct Goal {
  std::uint64_t goal_id = 0;
  std::string client_id;
  msg::GoalKind kind = msg::kGoalPosition;
  /// Depends on `kind`: a point, a NodeNumber or a place's name; ignored for cancel, pause and
  /// resume.
  planning::Target target = Eigen::Vector2d(0.0, 0.0);
  std::optional<double> heading_rad;  ///< of the robot in the end, map frame
  bool look_around = false;
};

/// Throws also when the target does not match `kind`.
msg::Goal to_msg(const Goal& goal, std::string_view robot_id, std::int64_t stamp_ns,
                 std::uint64_t sequence_number);
/// Rejects a place without a name.
Goal from_msg(const msg::Goal& message);

/// A route, found or not, with the motions for a robot that starts with heading `start_heading_rad`
/// (map frame). The sender fills in header, goal and versions. The clearance is infinite when there
/// is no obstacle at all.
msg::Route to_msg(const planning::HybridRoute& route, double start_heading_rad,
                  std::optional<double> final_heading_rad);
/// The map on which each part of a route was planned; rejects parts with points that the route
/// lacks.
std::vector<planning::RoutePart> route_parts_from_msg(const msg::Route& message);
/// The navigator's view of a route. Node positions come from `map`: pass the map of the route's
/// version, or null. Nodes that `map` lacks are left out, all of them when it is null.
navigation::RoutePlan route_plan_from_msg(const msg::Route& message,
                                          const planning::HybridMap* map);

}  // namespace topogeo::service
