#include "topogeo/storage/read_map.hpp"

#include <string_view>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/foreign_file.hpp"

namespace topogeo::storage {

MapDocument read_map(const std::filesystem::path& path) {
  constexpr std::string_view kSqlite = "SQLite format 3";
  return support::first_bytes(path, kSqlite.size()) == kSqlite
             ? MapDatabase::open_read_only(path).load()
             : read_map_file(path);
}

}  // namespace topogeo::storage
