// Three floors for closed-loop runs, each with the map that the system itself makes of it: a drive
// past everything is simulated, mapped as `topogeo map` does it, and the hybrid map is built from
// that.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/simulation/odometry.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::bench {

inline constexpr std::array<std::string_view, 3> kNavigationFloors{"office", "warehouse",
                                                                   "two loops"};

/// Error model of the wheels.
enum class Wheels : std::uint8_t {
  kMild = 0,  ///< the simulator's default
  kB21 = 1,   ///< that of a recorded log, see simulation::b21_odometry
};

simulation::OdometryDrift drift_of(Wheels wheels, std::uint64_t seed);

/// The B21 of all closed-loop runs.
simulation::RobotOptions b21_robot(const geometry::Pose2& T_world_start,
                                   const geometry::Pose2& T_robot_laser, Wheels wheels,
                                   double slip_per_m, std::uint64_t seed);

/// A floor of kNavigationFloors. Throws std::invalid_argument for another name, and as load_world.
world::World navigation_floor(std::string_view name);

/// Way points from the first point of the world's tour past everything that can be reached, and
/// back: each cell of the free space comes within 4 m in plain sight.
std::vector<Eigen::Vector2d> tour_of_everything(const world::World& world);

/// The tour of the world, which closes the long loops, back to its start, then the tour of
/// everything: a person's drive to make a map.
std::vector<Eigen::Vector2d> mapping_tour(const world::World& world);

struct MappedFloor {
  world::World world;
  std::shared_ptr<const localization::StoredMap> stored;
  std::shared_ptr<const planning::HybridMap> map;
  std::vector<geometry::Pose2> T_world_stop;  ///< the truth of each stop of the map
  double tour_m = 0.0;
  double seconds = 0.0;  ///< duration of the drive and its mapping

  /// Frame of the map, by its first stop.
  [[nodiscard]] geometry::Pose2 T_world_map() const;
  /// Frame of the map at the stop nearest to `point_m` (world), which excludes the bend of the map
  /// between the first stop and that one.
  [[nodiscard]] geometry::Pose2 T_world_map_at(const Eigen::Vector2d& point_m) const;
};

MappedFloor map_floor(std::string_view name, const pipeline::Config& config, Wheels wheels,
                      std::uint64_t seed);

}  // namespace topogeo::bench
