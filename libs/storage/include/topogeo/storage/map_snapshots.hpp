// Named copies of a map database, in a folder beside it.
//
// They are made with SQLite's backup: a consistent state while a map store writes, which is not
// held up. A copy gets its name once it is whole and on the disk. To restore, the copy is written
// into the database as one transaction: the loss of the process or the power at any moment leaves
// the map of before or the restored one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

struct MapSnapshot {
  std::string name;
  std::filesystem::path path;
  std::int64_t time_s = 0;  ///< when it was made, seconds since 1970
  std::uintmax_t bytes = 0;
  std::string damage;  ///< why it cannot be read; empty: it can be, and what follows holds
  std::uint64_t map_id = 0;
  std::uint64_t trajectory_version = 0;
  std::uint32_t stops = 0;  ///< in the map
};

/// The snapshots of a database by time, then name; none without a folder of them.
std::vector<MapSnapshot> snapshots_of(const std::filesystem::path& database);

/// Throws std::invalid_argument unless the name has 1 to 64 letters, digits, '.', '-' and '_' and
/// does not begin with '.'.
void check_snapshot_name(std::string_view name);

/// Copies the database. Throws std::invalid_argument for a wrong name, std::runtime_error naming
/// the file when there is a snapshot of this name, the database is none or damaged, or the disk is
/// full; nothing is left behind then.
MapSnapshot take_snapshot(const std::filesystem::path& database, const std::string& name);

/// Makes a snapshot of a map that came from elsewhere. Throws as take_snapshot() does, and
/// std::runtime_error for a map of another robot or seed than the database, which could not go on
/// with it; std::invalid_argument for one that contradicts itself.
MapSnapshot import_snapshot(const std::filesystem::path& database, const std::string& name,
                            const MapDocument& map);

/// Makes the database what the snapshot is. The former content becomes the snapshot that is
/// returned (before-NAME, with a number if that is taken); a file that is damaged is moved there as
/// it is. Throws as take_snapshot() does, and when another program has the database open. `after`
/// is called after each step with its name.
std::optional<MapSnapshot> restore_snapshot(
    const std::filesystem::path& database, const std::string& name,
    const std::function<void(std::string_view)>& after = [](std::string_view) {});

}  // namespace topogeo::storage
