// Upserts for one table of the map database: writes only blobs whose hash differs from the stored
// one.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

namespace topogeo::storage {

/// SQLite stores signed integers; hashes keep their bits.
inline std::int64_t as_signed(std::uint64_t value) {
  return std::bit_cast<std::int64_t>(value);
}
inline std::uint64_t as_unsigned(std::int64_t value) {
  return std::bit_cast<std::uint64_t>(value);
}

/// Binds an empty blob as a blob without bytes.
void bind_blob(SQLite::Statement& statement, int index, const std::string& blob);

/// Hash of each stored blob of a table by id.
using BlobHashes = std::map<std::uint32_t, std::uint64_t>;

class TableWriter {
 public:
  /// `extra_columns` are "" or ", a, b" beside id, blob_hash and blob.
  TableWriter(SQLite::Database& database, const std::string& table,
              const std::string& extra_columns = "", const std::string& extra_parameters = "");

  /// `numbers` and then `texts` are the values of the extra columns.
  void put(BlobHashes& hashes, std::uint32_t id, const std::string& blob,
           std::initializer_list<std::int64_t> numbers = {},
           std::initializer_list<std::string> texts = {});

  void remove_others(BlobHashes& hashes, const std::function<bool(std::uint32_t)>& is_kept);

 private:
  SQLite::Statement upsert_;
  SQLite::Statement remove_;
};

}  // namespace topogeo::storage
