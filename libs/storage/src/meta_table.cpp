#include "meta_table.hpp"

#include <stdexcept>

#include <SQLiteCpp/Statement.h>

#include "topogeo/support/format.hpp"

#include "sqlite_rows.hpp"

namespace topogeo::storage {

void write_meta(SQLite::Database& database, const std::string& key, const std::string& value) {
  SQLite::Statement statement(database, "INSERT OR REPLACE INTO meta(key, value) VALUES(?, ?)");
  statement.bind(1, key);
  statement.bind(2, value);
  statement.exec();
}

std::string read_meta(SQLite::Database& database, const std::string& key) {
  SQLite::Statement statement(database, "SELECT value FROM meta WHERE key = ?");
  statement.bind(1, key);
  if (!statement.executeStep()) {
    throw std::runtime_error(fmt::format("{}: damaged (no '{}')", database.getFilename(), key));
  }
  return text_at(statement, 0);
}

std::uint64_t read_meta_number(SQLite::Database& database, const std::string& key) {
  const std::string text = read_meta(database, key);
  try {
    std::size_t used = 0;
    const std::uint64_t value = std::stoull(text, &used);
    if (used == text.size()) return value;
  } catch (const std::logic_error&) {  // reported below
  }
  throw std::runtime_error(fmt::format("{}: damaged ({} is '{}', expected a number)",
                                       database.getFilename(), key, text));
}

std::uint64_t read_meta_number_or(SQLite::Database& database, const std::string& key,
                                  std::uint64_t otherwise) {
  SQLite::Statement statement(database, "SELECT 1 FROM meta WHERE key = ?");
  statement.bind(1, key);
  return statement.executeStep() ? read_meta_number(database, key) : otherwise;
}

std::string read_meta_or_empty(SQLite::Database& database, const std::string& key) {
  SQLite::Statement statement(database, "SELECT value FROM meta WHERE key = ?");
  statement.bind(1, key);
  return statement.executeStep() ? text_at(statement, 0) : std::string();
}

}  // namespace topogeo::storage
