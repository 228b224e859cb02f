// Reads the blobs of a map database, checked by their hashes.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"
#include "sqlite_rows.hpp"
#include "table_writer.hpp"

namespace topogeo::storage {

/// Parses the blob of the statement's row: columns id, blob_hash, blob. Throws std::runtime_error
/// naming the file, the row as `what` and its id, and the damage.
template <typename Message>
auto parse_row(const SQLite::Statement& row, const std::string& file, std::string_view what) {
  const std::string_view blob = blob_at(row, 2);
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(
        fmt::format("{}: {} {} is damaged ({})", file, what, integer_at(row, 0), why));
  };
  if (as_unsigned(integer_at(row, 1)) != support::fnv1a(blob)) fail("its hash is wrong");
  Message message;
  if (!message.ParseFromArray(blob.data(), static_cast<int>(blob.size()))) {
    fail("no valid Protobuf message");
  }
  try {
    return from_proto(message);
  } catch (const std::runtime_error& error) {
    fail(error.what());
    throw;
  }
}

template <typename Message, typename Value>
void read_table(SQLite::Database& database, const std::string& file, const char* table,
                std::vector<Value>& values) {
  SQLite::Statement row(database,
                        fmt::format("SELECT id, blob_hash, blob FROM {} ORDER BY id", table));
  while (row.executeStep()) values.push_back(parse_row<Message>(row, file, table));
}

}  // namespace topogeo::storage
