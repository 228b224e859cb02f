// The rows of a damaged SQLite file that can still be read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace topogeo::storage {

struct SalvagedRow {
  std::map<std::string, std::int64_t> numbers;  ///< by column
  std::map<std::string, std::string> texts;     ///< texts and blobs
};

struct SalvagedTable {
  std::vector<SalvagedRow> rows;
  bool complete = true;           ///< false: pages of it cannot be read
  std::size_t damaged_blobs = 0;  ///< rows left out because `blob` is not what `blob_hash` says
};

/// The tables by name. Each is read from its first row up to the first one that cannot be read, and
/// then from its last one back. The file and its log stay as they are: a copy is read, which is
/// removed afterwards. Throws std::runtime_error naming the file when not even its tables are
/// known.
std::map<std::string, SalvagedTable> salvage_tables(const std::filesystem::path& path);

}  // namespace topogeo::storage
