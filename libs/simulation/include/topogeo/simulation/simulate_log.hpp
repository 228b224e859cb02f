// A whole synthetic log with its truth: drive, ray casting, laser noise, odometry drift.
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/simulation/drive.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/simulation/odometry.hpp"
#include "topogeo/simulation/world.hpp"

namespace topogeo::simulation {

struct SimulationOptions {
  std::uint64_t seed = 1;
  double scan_step_m = 0.25;  ///< a scan after this much path; [0.01, 10]
  double scan_step_rad = 8.0 * std::numbers::pi / 180.0;  ///< or this much turning; [0.01, pi]
  std::int64_t start_stamp_ns = 1'000'000'000;            ///< stamp of the first scan; >= 0
  DriveOptions drive{};
  BeamPattern beams{};
  LaserNoise laser{};
  OdometryDrift odometry{};
};

struct SimulatedLog {
  std::vector<scan::Scan> scans;
  std::vector<geometry::Pose2> T_world_robot;  ///< true pose of each scan
};

/// Drives the tour of the world and scans on the way, the first time at its start, the last time at
/// its end. The laser sits at the robot's origin. The result depends on the arguments alone, to the
/// last bit. Throws std::invalid_argument for an option out of range or a world without a tour,
/// std::runtime_error when the tour cannot be driven (see drive).
SimulatedLog simulate_log(const World& world, const SimulationOptions& options);

}  // namespace topogeo::simulation
