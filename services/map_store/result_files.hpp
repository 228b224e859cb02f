// The files of a map store's directory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::map_store {

/// Moves the database of an earlier run out of the way, to NAME.previous.EXTENSION. Throws
/// service::BadInputError when the file is no readable topogeo database; nothing is moved then.
void set_aside_database(const std::filesystem::path& path);

/// Opens the existing database to continue it, or a new one. Throws service::BadInputError when the
/// existing one cannot be used; it stays unchanged.
storage::MapDatabase last_database(const std::filesystem::path& path, const std::string& robot_id,
                                   std::uint64_t seed);

/// Puts the map to extend into a new database; a database that began with that map stays unchanged.
/// Throws service::BadInputError when it holds another map.
void begin_with(storage::MapDatabase& database, const storage::MapDocument& continued);

/// Writes the files of results::write_map_outputs, and map.pb last, so that a new map.pb implies
/// that the others are new, too. Throws std::runtime_error naming the file.
void write_results(const std::filesystem::path& directory, const storage::MapDocument& document,
                   const std::string& title);

}  // namespace topogeo::map_store
