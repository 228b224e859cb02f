// One simulated drive to a goal on a mapped floor: start, goal and an unexpected obstacle drawn
// from a seed, driven in a closed loop, and scored with the truth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/world/world.hpp"

#include "navigation_floors.hpp"

namespace topogeo::bench {

enum class ObstacleKind : std::uint8_t { kNone = 0, kBox, kColumn, kPerson, kShutDoor };

/// A word for tables: "none", "box", ...
const char* to_string(ObstacleKind kind);

struct ArrivalTask {
  std::uint64_t seed = 0;
  geometry::Pose2 T_map_start;
  geometry::Pose2 T_map_goal;
  geometry::Pose2 T_world_start;
  std::vector<Eigen::Vector2d> route_m;  ///< planned before the obstacle, map frame
  double route_length_m = 0.0;
  ObstacleKind obstacle = ObstacleKind::kNone;
  Eigen::Vector2d obstacle_m = Eigen::Vector2d::Zero();  ///< its middle, world frame
  bool appears = false;                                  ///< once the robot is 1.5 to 3 m from it
  world::World world;                                    ///< with the obstacle
};

struct ArrivalConfig {
  pipeline::Config system;
  navigation::NavigatorConfig navigator;
  Wheels wheels = Wheels::kMild;
  double slip_per_m = 0.2;
  double obstacle_share = 1.0 / 3.0;
  double goal_clearance_m = 0.4;  ///< of start and goal, to occupied cells of the map
  bool pose_given = true;         ///< false: the start is unknown, the robot may look around
  double longest_s = 600.0;       ///< of simulated time
};

/// Start and goal of one run, with a route of at least 3 m between them; in some runs an obstacle
/// on the planned route that leaves another one free. The same arguments draw the same task.
ArrivalTask draw_task(const MappedFloor& floor, const ArrivalConfig& config, std::uint64_t seed);

struct TracePoint {
  double time_s = 0.0;
  geometry::Pose2 T_world_robot;
  std::optional<geometry::Pose2> T_map_robot;
  navigation::NavigatorStatus status;
};

struct ArrivalResult {
  bool arrived = false;  ///< as the navigator reports
  /// Error of the robot at the end, against the goal in the map around the robot ...
  double error_m = 0.0;
  double heading_error_rad = 0.0;
  double world_error_m = 0.0;  ///< ... and in the frame of its first stop, with the bend of the map
  double pose_error_m = 0.0;   ///< of the estimated pose against the true one, as error_m
  std::uint64_t collisions = 0;
  std::uint64_t run_into = 0;
  double time_s = 0.0;
  double path_m = 0.0;
  std::uint32_t detours = 0;
  std::uint32_t guard_stops = 0;
  std::size_t plans = 0;
  std::string end;  ///< state, reason and message of the navigator at the end

  [[nodiscard]] bool good() const;  ///< arrived within 10 cm and 5 degrees, without a collision
};

/// Additional data of a run, for pictures and traces.
struct ArrivalRecord {
  std::vector<TracePoint> trace;  ///< five times a second
  std::vector<std::vector<Eigen::Vector2d>> routes_m;
};

ArrivalResult run_arrival(const MappedFloor& floor, const ArrivalConfig& config,
                          const ArrivalTask& task, ArrivalRecord* record = nullptr);

}  // namespace topogeo::bench
