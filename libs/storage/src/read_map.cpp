#include "topogeo/storage/read_map.hpp"

#include <fstream>
#include <string>
#include <string_view>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"

namespace topogeo::storage {

MapDocument read_map(const std::filesystem::path& path) {
  constexpr std::string_view kSqlite = "SQLite format 3";
  std::string start(kSqlite.size(), '\0');
  std::ifstream(path, std::ios::binary)
      .read(start.data(), static_cast<std::streamsize>(start.size()));
  return start == kSqlite ? MapDatabase::open_read_only(path).load() : read_map_file(path);
}

}  // namespace topogeo::storage
