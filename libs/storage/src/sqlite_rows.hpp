// Additions to SQLiteCpp for the map database: columns with checked types, and errors that name the
// file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>

namespace topogeo::storage {

/// Columns of the statement's row, counted from 0. They throw SQLite::Exception if the column has
/// another type.
std::int64_t integer_at(const SQLite::Statement& row, int column);
std::string text_at(const SQLite::Statement& row, int column);
std::string_view blob_at(const SQLite::Statement& row, int column);  ///< valid until the next step

/// Throws std::runtime_error with the file, and the meaning of the error for a map database.
[[noreturn]] void throw_named(const std::string& file, const SQLite::Exception& error);

}  // namespace topogeo::storage
