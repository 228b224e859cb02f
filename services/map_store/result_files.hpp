// The files of a map store's directory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::map_store {

/// An empty database in place of the one that an earlier run has left, which is kept under the name
/// NAME.previous.EXTENSION. Throws
/// service::BadInputError when the file there is no readable topogeo database (nothing is removed
/// then) or the new one cannot be made.
storage::MapDatabase fresh_database(const std::filesystem::path& path, const std::string& robot_id,
                                    std::uint64_t seed);

/// Writes what results::write_map_outputs does, and map.pb last, so that where map.pb is new the
/// others are too. Throws std::runtime_error naming the file.
void write_results(const std::filesystem::path& directory, const storage::MapDocument& document,
                   const std::string& title);

}  // namespace topogeo::map_store
