// What the map database needs besides SQLiteCpp: columns that must be of their type, and errors
// that name the file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>

namespace topogeo::storage {

/// Columns of the statement's row, counted from 0. They throw SQLite::Exception when the column is
/// not of that type.
std::int64_t integer_at(const SQLite::Statement& row, int column);
std::string text_at(const SQLite::Statement& row, int column);
std::string_view blob_at(const SQLite::Statement& row, int column);  ///< valid until the next step

/// Throws std::runtime_error with the file, and what the error means for a map database.
[[noreturn]] void throw_named(const std::string& file, const SQLite::Exception& error);

}  // namespace topogeo::storage
