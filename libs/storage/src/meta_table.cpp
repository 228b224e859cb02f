#include "meta_table.hpp"

#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::storage {

bool has_table(SqliteConnection& connection, const std::string& name) {
  SqliteStatement statement(connection,
                            "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?");
  return statement.bind_text(1, name).step();
}

void write_meta(SqliteConnection& connection, const std::string& key, const std::string& value) {
  SqliteStatement(connection, "INSERT OR REPLACE INTO meta(key, value) VALUES(?, ?)")
      .bind_text(1, key)
      .bind_text(2, value)
      .run();
}

std::string read_meta(SqliteConnection& connection, const std::string& key) {
  SqliteStatement statement(connection, "SELECT value FROM meta WHERE key = ?");
  if (!statement.bind_text(1, key).step()) {
    throw std::runtime_error(fmt::format("{}: damaged (no '{}')", connection.name(), key));
  }
  return statement.text(0);
}

std::uint64_t read_meta_number(SqliteConnection& connection, const std::string& key) {
  const std::string text = read_meta(connection, key);
  try {
    std::size_t used = 0;
    const std::uint64_t value = std::stoull(text, &used);
    if (used == text.size()) return value;
  } catch (const std::logic_error&) {  // reported below
  }
  throw std::runtime_error(
      fmt::format("{}: damaged ({} is '{}', expected a number)", connection.name(), key, text));
}

}  // namespace topogeo::storage
