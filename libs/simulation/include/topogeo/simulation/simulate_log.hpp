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
/// Neither odometry nor the time notice.
struct Kidnapping {
  double at_path_m = 0.0;  ///< of the path driven
  double to_path_m = 0.0;  ///< of the path of the whole tour; before or after
};

/// Scans on a part of the path driven that see nothing of the world.
struct Blinding {
  world::DistanceInterval path;
  /// What every beam reads then; without it no beam has an echo.
  std::optional<double> reading_m;
};

struct SimulationOptions {
  std::uint64_t seed = 1;
  double scan_step_m = 0.25;  ///< a scan after this much path; [0.01, 10]
  double scan_step_rad = 8.0 * std::numbers::pi / 180.0;  ///< or this much turning; [0.01, pi]
  std::int64_t start_stamp_ns = 1'000'000'000;            ///< stamp of the first scan; >= 0
  DriveOptions drive{};
  BeamPattern beams{};
  LaserNoise laser{};
  OdometryDrift odometry{};
  geometry::Pose2 T_robot_laser{};  ///< where the laser sits
  /// People besides those of the world: they walk about at random, starting near the tour, each at
  /// a speed of its own of 0.5 to 1.5 m/s, and turn away from walls and the robot.
  std::size_t wanderers = 0;
  std::vector<Kidnapping> kidnappings{};  ///< in the order of their at_path_m
  std::vector<Blinding> blindings{};
};

struct SimulatedLog {
  std::vector<scan::Scan> scans;
  std::vector<geometry::Pose2> T_world_robot;  ///< true pose of each scan
};

/// Drives the tour of the world and scans along it, the first time at its start, the last time at
/// its end. Nothing stops the robot: doors that are shut and people in its way are no obstacle, and
/// a person within 0.15 m of the laser is left out of a scan. The result depends on the arguments
/// alone, to the last bit. Throws std::invalid_argument for an option out of range or a world
/// without a tour, std::runtime_error when the tour cannot be driven (see drive).
SimulatedLog simulate_log(const world::World& world, const SimulationOptions& options);

}  // namespace topogeo::simulation
