// One drive through a synthetic floor, mapped and compared with the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::bench {

struct SyntheticFloor {
  std::string name;
  std::function<world::World(std::uint64_t seed)> draw;
  bool large = false;  ///< hundreds of metres to drive instead of about a hundred
};

/// The floors of the synthetic table, in its order.
const std::vector<SyntheticFloor>& synthetic_floors();

/// The drive of a seed through a floor: a scan every 0.35 m or 10 degrees, odometry by
/// simulation::b21_odometry.
simulation::SimulatedLog synthetic_drive(const world::World& world, std::uint64_t seed);

/// The drive of a person who carries a laser through a floor (1.2 m/s, 90 degrees a second, 10
/// scans a second, 12 m), with odometry from its scans; those that it cannot place are left out.
simulation::SimulatedLog hand_held_drive(const world::World& world, std::uint64_t seed);

/// An accepted loop closure that disagrees with the truth.
struct FalseLoop {
  std::uint32_t earlier_id = 0;
  std::uint32_t later_id = 0;
  double off_m = 0.0;
  double off_rad = 0.0;
  double apart_m = 0.0;  ///< true distance of the two places
};

struct SyntheticResult {
  std::uint64_t seed = 0;
  std::size_t scans = 0;
  std::size_t stops = 0;
  double path_m = 0.0;            ///< true
  double odometry_rms_m = 0.0;    ///< after the best rigid alignment
  double rms_m = 0.0;             ///< the same for the corrected poses
  double largest_m = 0.0;         ///< error after the alignment
  double rms_from_start_m = 0.0;  ///< without alignment but for the first pose
  double heading_rad = 0.0;       ///< mean absolute error after the alignment
  double local_m = 0.0;           ///< rms error of a step between successive stops
  double local_rad = 0.0;
  double scale = 0.0;           ///< corrected length over true length between stops, less 1
  double odometry_scale = 0.0;  ///< the same for odometry
  std::size_t loops = 0;        ///< true returns, see count_loops
  std::size_t loops_closed = 0;
  std::size_t pieces = 0;  ///< returns cut into pieces of at most 10 m
  std::size_t pieces_closed = 0;
  std::size_t closures = 0;  ///< accepted in the end
  std::vector<FalseLoop> false_loops;
  double cpu_s = 0.0;
};

/// Maps a log and compares it with its truth. `document`, when given, receives the map.
///
/// A return is a stretch of 3 m or more on which the robot is within 1.5 m of a stop made at least
/// 15 m of path earlier; it is closed when one of its stops is the later end of a right loop
/// closure whose earlier end was at least 15 m of path before. A closure is false when it is off by
/// more than 0.5 m or 10 degrees.
SyntheticResult run_synthetic(const simulation::SimulatedLog& log, const pipeline::Config& config,
                              storage::MapDocument* document = nullptr);

/// Writes NAME.clf.gz and NAME.tum (the truth) into a folder.
void save_log(const simulation::SimulatedLog& log, const std::filesystem::path& folder,
              const std::string& name);

}  // namespace topogeo::bench
