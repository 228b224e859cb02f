// Inputs and reports of a navigator. All stamps are on one clock, nanoseconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/planning/route_parts.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::navigation {

/// Pose of the robot from a localizer.
struct PoseFix {
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_map_robot;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  bool tracking = false;  ///< only then may the robot set out for a goal
  bool located = false;   ///< not tracking, but the pose is usable: it may drive on for a while
  /// Located, and not tracking only because the covariance is large, as along a bare corridor: the
  /// robot may drive on as far as that goes.
  bool place_known = false;
  std::string state_text;  ///< for people, if it is not: "searching", "lost", ...
};

struct OdometrySample {
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_odom_robot;
};

/// Points where laser beams ended, robot frame, with the odometry at that time. A beam without an
/// echo gives none.
struct ScanPoints {
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_odom_robot;
  geometry::Pose2 T_robot_laser;
  std::vector<Eigen::Vector2d> points_m;
  /// The scan itself, for the momentary local map; may be null.
  std::shared_ptr<const scan::Scan> scan{};
};

/// One sonar's reading.
struct SonarReading {
  geometry::Pose2 T_robot_sonar;  ///< its axis is x
  double half_cone_rad = 0.0;
  float range_m = 0.0F;  ///< scan::Scan::kNoReturn without an echo
};

struct SonarRound {
  std::int64_t stamp_ns = 0;
  std::vector<SonarReading> readings;
};

/// State of the fields that the laser itself watches (SICK PLS: OSSD outputs and WEAK SIGNAL). The
/// warning field contains the protective field.
struct LaserFields {
  std::int64_t stamp_ns = 0;
  bool warning = false;
  bool protective = false;
};

struct BaseCondition {
  std::int64_t stamp_ns = 0;
  bool commands_taken = true;
  std::string reason;  ///< for people, when they are not
};

/// Inputs whose delay is measured by their stamps.
enum class TimedInput : std::uint8_t { kPose = 0, kOdometry = 1, kScan = 2, kSonar = 3 };
inline constexpr std::size_t kTimedInputs = static_cast<std::size_t>(TimedInput::kSonar) + 1;

/// Recent CPU shortage of the navigator's program.
struct MachineLoad {
  bool busy = false;           ///< its threads waited for a CPU and its timers were late
  double timer_delay_s = 0.0;  ///< the largest
};

/// A planner's route to a goal; sent again after changes.
struct RoutePlan {
  std::uint64_t goal_id = 0;
  std::uint64_t map_version = 0;
  std::uint64_t blockages_version = 0;  ///< of the blockages that it avoids
  bool found = false;
  std::string reason;                        ///< one line for people; empty if found
  std::vector<Eigen::Vector2d> points_m;     ///< map frame, straightened, from start to goal
  std::vector<double> clearances_m{};        ///< of the points; needed for those on branches
  std::vector<planning::RoutePart> parts{};  ///< basis of the plan; empty: the grid
  std::vector<Eigen::Vector2d> nodes_m;      ///< border nodes along it, in order, map frame
  std::optional<double> heading_rad;         ///< wanted at the goal, map frame
};

/// A goal, identified by its number only: the route follows.
struct GoalOrder {
  std::uint64_t goal_id = 0;
  bool look_around = false;  ///< without a pose: may turn and move a little if nothing is near
};

enum class NavigatorState : std::uint8_t {
  kIdle = 0,  ///< no goal
  kDriving = 1,
  kRelocalizing = 2,  ///< stands, or looks around, to find its pose
  kBlocked = 3,       ///< waits for a free path or another route
  kArrived = 4,
  kStopped = 5,  ///< has a goal and does not drive: see the reason
};

/// Reason for not driving.
enum class HaltReason : std::uint8_t {
  kNone = 0,
  kWaitsForRoute = 1,
  kNoRoute = 2,  ///< the planner has none
  kCancelled = 3,
  kPaused = 4,
  kPoseLost = 5,  ///< the pose is unknown or too uncertain
  kNoMap = 6,
  kOutsideMap = 7,  ///< the robot is not on the map
  kObstacle = 8,    ///< an obstacle that is not on the map
  kNoScan = 9,
  kSonarSilent = 10,  ///< the sonars have no echo, though something is near
  kNoOdometry = 11,
  kBaseNotReady = 12,  ///< refuses commands, or an operator's stop holds
  kBaseStuck = 13,     ///< does not move when ordered to
};

/// Short text for logs and messages: "driving", ...
std::string_view describe(NavigatorState state);
/// Short text for the reason: "the pose is lost", ...
std::string_view describe(HaltReason reason);

struct NavigatorStatus {
  NavigatorState state = NavigatorState::kIdle;
  HaltReason reason = HaltReason::kNone;
  std::string message;        ///< one line for people: the activity, or the reason for not driving
  bool busy_machine = false;  ///< the message blames a machine that is too busy
  std::uint64_t goal_id = 0;  ///< 0: none
  double driven_m = 0.0;      ///< since the goal was given, by odometry
  double rest_m = 0.0;        ///< of the route
  double rest_s = 0.0;        ///< until the arrival, approximately
  std::optional<geometry::Pose2> T_map_robot;  ///< now; nothing if unknown
  geometry::Velocity command;                  ///< of the last step()
  double free_ahead_m = 0.0;          ///< free distance in the direction of motion, at most 5
  std::uint32_t detours = 0;          ///< round obstacles that are not on the map, for this goal
  std::uint32_t branch_detours = 0;   ///< of these along branches of the scan
  std::uint32_t virtual_detours = 0;  ///< of these along virtual ones
  std::uint32_t routes = 0;           ///< accepted for the goal
  std::uint32_t guard_stops = 0;      ///< stops by the collision guard for this goal
};

/// Obstacles in the way that are not on the map; the planner should avoid them.
struct BlockageReport {
  std::uint64_t version = 0;              ///< counts the changes
  std::vector<Eigen::Vector2d> points_m;  ///< map frame: middles of occupied cells
};

}  // namespace topogeo::navigation
