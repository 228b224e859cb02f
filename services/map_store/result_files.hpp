// The files of a map store's directory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::map_store {

/// Moves the database that an earlier run has left out of the way, to NAME.previous.EXTENSION.
/// Throws service::BadInputError when the file there is no readable topogeo database; nothing is
/// moved then.
void set_aside_database(const std::filesystem::path& path);

/// The database that is there, to go on with it, or a new one. Throws service::BadInputError when
/// what is there cannot be used; it stays as it is then.
storage::MapDatabase last_database(const std::filesystem::path& path, const std::string& robot_id,
                                   std::uint64_t seed);

/// Puts the map that is to be extended into a new database; one that began with it stays as it is.
/// Throws service::BadInputError when it holds another map.
void begin_with(storage::MapDatabase& database, const storage::MapDocument& continued);

/// Writes what results::write_map_outputs does, and map.pb last, so that where map.pb is new the
/// others are too. Throws std::runtime_error naming the file.
void write_results(const std::filesystem::path& directory, const storage::MapDocument& document,
                   const std::string& title);

}  // namespace topogeo::map_store
