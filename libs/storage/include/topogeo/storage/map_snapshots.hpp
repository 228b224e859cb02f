// Named copies of a map database, in a folder beside it.
//
// SQLite's backup makes them: a consistent state even while a map store writes, without delaying
// it. A copy gets its name once it is complete and on the disk. Restoring writes the copy into the
// database as one transaction, so the loss of the process or the power at any moment leaves either
// the previous map or the restored one.
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
  std::int64_t time_s = 0;  ///< creation time, seconds since 1970
  std::uintmax_t bytes = 0;
  std::string damage;  ///< why it cannot be read; empty: the fields below are valid
  std::uint64_t map_id = 0;
  std::uint64_t trajectory_version = 0;
  std::uint32_t stops = 0;  ///< in the map
};

/// The snapshots of a database by time, then name; none without a snapshot folder.
std::vector<MapSnapshot> snapshots_of(const std::filesystem::path& database);

/// Throws std::invalid_argument unless the name has 1 to 64 letters, digits, '.', '-' and '_' and
/// does not begin with '.'.
void check_snapshot_name(std::string_view name);

/// Copies the database. Throws std::invalid_argument for a wrong name, std::runtime_error naming
/// the file if a snapshot has this name already, the file is no database or damaged, or the disk is
/// full; nothing is left behind then.
MapSnapshot take_snapshot(const std::filesystem::path& database, const std::string& name);

/// Makes a snapshot of an external map. Throws like take_snapshot(), and std::runtime_error for a
/// map of another robot or seed than the database, which could not continue it;
/// std::invalid_argument for a map that contradicts itself.
MapSnapshot import_snapshot(const std::filesystem::path& database, const std::string& name,
                            const MapDocument& map);

/// Deletes a snapshot. Throws std::invalid_argument for a wrong name, std::runtime_error if there
/// is none of this name.
void remove_snapshot(const std::filesystem::path& database, const std::string& name);

/// Gives a snapshot another name. Throws like remove_snapshot(), and if the name is used.
void rename_snapshot(const std::filesystem::path& database, const std::string& name,
                     const std::string& new_name);

/// Replaces the database by the snapshot. The former content becomes the returned snapshot
/// (before-NAME, with a number if that is used); a damaged file is moved there unchanged. Throws
/// like take_snapshot(), and if another program has the database open. `after` is called after each
/// step with its name.
std::optional<MapSnapshot> restore_snapshot(
    const std::filesystem::path& database, const std::string& name,
    const std::function<void(std::string_view)>& after = [](std::string_view) {});

}  // namespace topogeo::storage
