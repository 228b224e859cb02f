// Map files on the command line of `topogeo store`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::cli {

/// A map file (map.pb) or map database, recognized by its content. Throws service::BadInputError
/// naming the file and the cause.
storage::MapDocument read_any_map(const std::filesystem::path& file);

/// Whether the file begins like a map file or a map database.
bool looks_like_map(const std::filesystem::path& file);

/// Whether the file begins like an SQLite file.
bool looks_like_database(const std::filesystem::path& file);

}  // namespace topogeo::cli
