// One simulated drive of a robot without a laser: it starts at the base station of a drawn floor,
// localizes by Markov localization with its sonars alone, and drives the primitives of the hybrid
// planner's route to a goal (MACONDO, III; docs/algorithms.md, "Markov localization").
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/world/world.hpp"

#include "navigation_floors.hpp"

namespace topogeo::bench {

/// A floor drawn by hand; the frame of the map is that of the world.
struct DrawnFloor {
  std::string name;
  world::World world;
  std::shared_ptr<const planning::HybridMap> map;
};

/// "office", "warehouse", "two loops" as in navigation_floors.hpp, and "rooms". Throws
/// std::invalid_argument for another name.
DrawnFloor draw_floor(std::string_view name, const pipeline::HybridMapConfig& config);

/// The floors of the table.
std::vector<std::string> drawn_floor_names();

struct SonarDriveConfig {
  pipeline::Config system;
  Wheels wheels = Wheels::kMild;
  int sonars = 24;  ///< the 24 of a B21, or the 6 of MACONDO
  double slip_per_m = 0.2;
  double goal_clearance_m = 0.4;  ///< of station and goal, to occupied cells of the map
  /// Accuracy of placing the robot on its base station, one sigma.
  double station_sigma_m = 0.03;
  double station_sigma_rad = 0.035;
  double obstacle_share = 0.0;  ///< share of drives with an unmapped box on the route
  double longest_s = 900.0;     ///< of simulated time
};

/// With the settings of this file, or of deploy/sonar_robot.example.yaml. Throws like load_config.
SonarDriveConfig sonar_drive_config(const std::filesystem::path& settings = {});

struct SonarTask {
  std::uint64_t seed = 0;
  geometry::Pose2 T_map_station;
  geometry::Pose2 T_world_start;
  geometry::Pose2 T_map_goal;
  double route_length_m = 0.0;
  world::World world;  ///< with the box, if there is one
  bool obstacle = false;
};

/// Draws a station and a goal with a route of at least 3 m between them. The same arguments draw
/// the same task.
SonarTask draw_sonar_task(const DrawnFloor& floor, const SonarDriveConfig& config,
                          std::uint64_t seed);

struct SonarResult {
  bool arrived = false;    ///< as the navigator reports
  double error_m = 0.0;    ///< of the robot to the goal, at the end
  double error_x_m = 0.0;  ///< along the axes of the grid
  double error_y_m = 0.0;
  double heading_error_rad = 0.0;
  double pose_error_m = 0.0;     ///< of the reported pose to the true one, at the end
  double largest_pose_m = 0.0;   ///< the same, largest of the drive
  std::uint64_t collisions = 0;  ///< of the robot with any object
  double time_s = 0.0;
  double path_m = 0.0;
  std::uint32_t guard_stops = 0;
  std::size_t plans = 0;
  std::string end;  ///< state, reason and message of the navigator at the end

  /// Arrived in the cell of the goal or one beside it (0.10 m along each axis of the grid), without
  /// a collision.
  [[nodiscard]] bool good() const;
};

/// `trace` may be empty; otherwise a CSV file of true and reported poses, room, commands and sonar
/// readings, five times a second.
SonarResult run_sonar_drive(const DrawnFloor& floor, const SonarDriveConfig& config,
                            const SonarTask& task, const std::filesystem::path& trace = {});

}  // namespace topogeo::bench
