#include "sqlite_rows.hpp"

#include <stdexcept>

#include <SQLiteCpp/Column.h>
#include <sqlite3.h>

#include "topogeo/sqlite_guard/sqlite_guard.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::storage {
namespace {

SQLite::Column column_of_type(const SQLite::Statement& row, int column, int type) {
  SQLite::Column found = row.getColumn(column);
  if (found.getType() != type) {
    throw SQLite::Exception(fmt::format("column {} has the wrong type", found.getName()),
                            SQLITE_MISMATCH);
  }
  return found;
}

}  // namespace

std::int64_t integer_at(const SQLite::Statement& row, int column) {
  return column_of_type(row, column, SQLITE_INTEGER).getInt64();
}

std::string text_at(const SQLite::Statement& row, int column) {
  return column_of_type(row, column, SQLITE_TEXT).getString();
}

std::string_view blob_at(const SQLite::Statement& row, int column) {
  const SQLite::Column found = column_of_type(row, column, SQLITE_BLOB);
  const void* bytes = found.getBlob();  // null for a blob without bytes
  if (bytes == nullptr) return {};
  return {static_cast<const char*>(bytes), static_cast<std::size_t>(found.getBytes())};
}

void throw_named(const std::string& file, const SQLite::Exception& error) {
  const auto named = [&](std::string_view what) {
    return std::runtime_error(fmt::format("{}: {}: {}", file, what, error.what()));
  };
  switch (error.getErrorCode()) {
    case SQLITE_NOTADB:
      throw std::runtime_error(file + ": not a map database (no SQLite file)");
    case SQLITE_CORRUPT:
      throw std::runtime_error(fmt::format("{}: cut short or damaged ({})", file, error.what()));
    case SQLITE_MISMATCH:
      throw std::runtime_error(fmt::format("{}: damaged ({})", file, error.what()));
    case SQLITE_INTERRUPT:
      throw std::runtime_error(fmt::format("{}: {}", file, sqlite_guard::kTooMuchWork));
    case SQLITE_CANTOPEN:
      throw named("cannot be opened");
    default:
      throw named("cannot be read or written");
  }
}

}  // namespace topogeo::storage
