// A whole synthetic log with its truth: drive, ray casting, laser noise, odometry drift.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/simulation/drive.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/simulation/odometry.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// The robot is lifted at one place of its tour and put down at another, where it drives on.
/// Neither odometry nor the clock notices.
struct Kidnapping {
  double at_path_m = 0.0;  ///< of the driven path
  double to_path_m = 0.0;  ///< of the whole tour's path; before or after
};

/// Scans on a part of the driven path that do not show the world.
struct Blinding {
  world::DistanceInterval path;
  /// Reading of every beam there; none: no beam has an echo.
  std::optional<double> reading_m;
};

struct SimulationOptions {
  std::uint64_t seed = 1;
  double scan_step_m = 0.25;                              ///< path between scans; [0.01, 10]
  double scan_step_rad = 8.0 * std::numbers::pi / 180.0;  ///< or turning between scans; [0.01, pi]
  std::int64_t start_stamp_ns = 1'000'000'000;            ///< stamp of the first scan; >= 0
  DriveOptions drive{};
  BeamPattern beams{};
  LaserNoise laser{};
  OdometryDrift odometry{};
  geometry::Pose2 T_robot_laser{};  ///< mounting of the laser
  /// People in addition to the world's: they walk about at random, starting near the tour, each at
  /// its own speed of 0.5 to 1.5 m/s, and turn away from walls and the robot.
  std::size_t wanderers = 0;
  std::vector<Kidnapping> kidnappings{};  ///< in the order of their at_path_m
  std::vector<Blinding> blindings{};
};

struct SimulatedLog {
  std::vector<scan::Scan> scans;
  std::vector<geometry::Pose2> T_world_robot;  ///< true pose of each scan
};

/// Drives the tour of the world and scans along it, first at its start and last at its end. Nothing
/// stops the robot: shut doors and people in its way are no obstacle, and scans leave out a person
/// within 0.15 m of the laser. The result depends only on the arguments, to the last bit. Throws
/// std::invalid_argument for an option out of range or a world without a tour, std::runtime_error
/// if the tour cannot be driven (see drive).
SimulatedLog simulate_log(const world::World& world, const SimulationOptions& options);

}  // namespace topogeo::simulation
