// Drives of different days through one building, each joined to the map of another.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::bench {

/// A drive and its own map.
struct SessionDrive {
  std::string name;
  pipeline::Config config;
  std::vector<scan::Scan> scans;
  storage::MapDocument map;
};

/// A stop of a drive before it joined a map.
struct FollowedStop {
  localization::LocalizationState state = localization::LocalizationState::kSearching;
  geometry::Pose2 T_stored_later;  ///< between the frames of the two maps, if its pose is right
  double path_m = 0.0;
  /// Contradicted share of its expected view (localization::contradiction()); only when tracked.
  std::optional<double> contradicted;
};

/// A drive that was to continue the map of another one.
struct SessionPair {
  std::size_t stored = 0;  ///< index of the drives
  std::size_t later = 0;
  std::size_t stops = 0;   ///< of the later drive
  std::size_t joined = 0;  ///< stops in the map at the end
  /// Path driven until the drive joined the map; empty: it did not join.
  std::optional<double> joined_after_m;
  geometry::Pose2 T_stored_later;  ///< between the two maps' frames, by the later drive's stops
  std::vector<FollowedStop> followed;
  double spread_m = 0.0;  ///< rms of the remaining differences between its stops in both maps
};

/// A cycle of three drives, composed of their pairs.
struct SessionCycle {
  std::vector<std::size_t> drives;
  double closing_m = 0.0;
  double closing_rad = 0.0;
};

/// A CARMEN log, mapped with its configuration. Throws std::runtime_error naming the file.
SessionDrive session_drive(const std::string& log_file, const std::string& name,
                           pipeline::LoadedConfig config);

SessionPair run_pair(const std::vector<SessionDrive>& drives, std::size_t stored,
                     std::size_t later);

/// All cycles of three drives, in both directions, whose pairs are joined.
std::vector<SessionCycle> cycles_of(const std::vector<SessionPair>& pairs, std::size_t drives);

}  // namespace topogeo::bench
