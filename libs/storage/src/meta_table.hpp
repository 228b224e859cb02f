// The table of keys and values that describes a map database.
#pragma once

#include <cstdint>
#include <string>

#include "sqlite.hpp"

namespace topogeo::storage {

bool has_table(SqliteConnection& connection, const std::string& name);

/// Replaces the value of the key.
void write_meta(SqliteConnection& connection, const std::string& key, const std::string& value);

/// Throws std::runtime_error naming file and key when there is none.
std::string read_meta(SqliteConnection& connection, const std::string& key);

/// The same, also when it is no number.
std::uint64_t read_meta_number(SqliteConnection& connection, const std::string& key);

}  // namespace topogeo::storage
