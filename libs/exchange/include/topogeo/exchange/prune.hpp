// Removes dispensable stops from a map: those of sessions that never joined it, and views of places
// that others show as well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/global_map_config.hpp"

namespace topogeo::exchange {

struct PruneSettings {
  /// Removes sessions whose last stop is this much older than the newest stop of all. The newest
  /// session stays, because it may go on.
  std::int64_t older_ns = 0;
  /// Views kept of each place, see localization::KeptViews; none: all views stay.
  std::optional<std::size_t> times;
  bool dry_run = false;  ///< the file is not changed
};

struct PrunedSession {
  std::uint64_t session = 0;
  std::size_t stops = 0;
  std::int64_t last_stamp_ns = 0;
};

struct Pruned {
  std::vector<PrunedSession> sessions;  ///< with removed stops
  std::size_t views_before = 0;         ///< in the map
  std::size_t views = 0;
  std::uintmax_t bytes_before = 0;  ///< of the file
  std::uintmax_t bytes = 0;
};

/// Prunes a map database in place; no map store may have it open. Throws like MapDatabase.
Pruned prune(const std::filesystem::path& database, const PruneSettings& settings,
             const topomap::GlobalMapConfig& config);

/// Keeps that many views of each place; nodes and branches are made anew if the map changes.
storage::MapDocument with_fewer_views(const storage::MapDocument& document, std::size_t times,
                                      const topomap::GlobalMapConfig& config);

}  // namespace topogeo::exchange
