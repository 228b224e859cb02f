// Reads the intact rows of a damaged SQLite file.
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
  bool complete = true;           ///< false: some of its pages cannot be read
  std::size_t damaged_blobs = 0;  ///< dropped rows whose `blob` does not match `blob_hash`
};

/// The tables by name. Each is read from its first row to the first unreadable one, and then from
/// its last row backwards. The file and its log are not changed: a temporary copy is read. Throws
/// std::runtime_error naming the file if not even its tables can be read.
std::map<std::string, SalvagedTable> salvage_tables(const std::filesystem::path& path);

}  // namespace topogeo::storage
