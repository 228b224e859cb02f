// A robot that patrols the same floor for a year: doors open and close, people walk about, a
// cupboard is moved now and then. Each drive is a session that joins the map of the earlier ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/pipeline/config.hpp"

namespace topogeo::bench {

struct PatrolOptions {
  std::size_t drives = 500;
  std::size_t drives_per_move = 20;  ///< between moves of the cupboard
  std::size_t people = 3;
  std::filesystem::path directory;  ///< folder of map.sqlite; created anew
};

struct PatrolDrive {
  std::size_t drive = 0;
  std::size_t stops = 0;
  std::size_t unmapped = 0;       ///< stops of the drive that did not join the map
  std::size_t map_stops = 0;      ///< after the drive
  std::size_t loops = 0;          ///< in the map
  std::size_t nodes = 0;          ///< of the global map
  double rms_m = 0.0;             ///< of the drive's stops, in the map frame, not aligned
  double map_rms_m = 0.0;         ///< of all stops of the map
  std::uintmax_t file_bytes = 0;  ///< map.sqlite with its write-ahead log
  double memory_mb = 0.0;         ///< of localizer and map store together
  double cpu_s = 0.0;
};

struct PatrolResult {
  std::vector<PatrolDrive> drives;
  bool same_in_store = true;             ///< after each drive the store had the localizer's map
  std::size_t ghosts = 0;                ///< occupied cells at earlier places of the cupboard
  std::size_t cupboard_cells = 0;        ///< occupied cells at its present place
  std::vector<std::size_t> ghost_cells;  ///< by place
};

/// Calls `on_drive` after each drive.
PatrolResult run_patrol(const PatrolOptions& options, const pipeline::Config& config,
                        const std::function<void(const PatrolDrive&)>& on_drive = {});

}  // namespace topogeo::bench
