// The table of keys and values that describes a map database.
#pragma once

#include <cstdint>
#include <string>

#include <SQLiteCpp/Database.h>

namespace topogeo::storage {

/// Replaces the value of the key.
void write_meta(SQLite::Database& database, const std::string& key, const std::string& value);

/// Throws std::runtime_error naming file and key if it is missing.
std::string read_meta(SQLite::Database& database, const std::string& key);

/// The same, also if it is not a number.
std::uint64_t read_meta_number(SQLite::Database& database, const std::string& key);

/// The value of the key; empty if it is missing.
std::string read_meta_or_empty(SQLite::Database& database, const std::string& key);

/// Like read_meta_number(), but `otherwise` if it is missing.
std::uint64_t read_meta_number_or(SQLite::Database& database, const std::string& key,
                                  std::uint64_t otherwise);

}  // namespace topogeo::storage
