#include "sqlite.hpp"

#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::storage {
namespace {

constexpr int kBusyTimeout_ms = 5000;

}  // namespace

SqliteConnection::SqliteConnection(const std::string& path, bool may_create) : name_(path) {
  sqlite3* opened = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | (may_create ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2(path.c_str(), &opened, flags, nullptr);
  handle_.reset(opened);  // to be closed even when the opening failed
  if (code != SQLITE_OK) fail("cannot be opened");
  sqlite3_busy_timeout(opened, kBusyTimeout_ms);
}

void SqliteConnection::execute(const char* sql) {
  if (sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail("cannot be changed");
  }
}

void SqliteConnection::fail(std::string_view doing) const {
  const int code = handle_ ? sqlite3_errcode(handle_.get()) : SQLITE_NOMEM;
  if (code == SQLITE_NOTADB) {
    throw std::runtime_error(name_ + ": not a map database (no SQLite file)");
  }
  const char* cause = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
  if (code == SQLITE_CORRUPT) {
    throw std::runtime_error(fmt::format("{}: cut short or damaged ({})", name_, cause));
  }
  throw std::runtime_error(fmt::format("{}: {}: {}", name_, doing, cause));
}

SqliteStatement::SqliteStatement(SqliteConnection& connection, const std::string& sql)
    : connection_(connection) {
  sqlite3_stmt* prepared = nullptr;
  const int code = sqlite3_prepare_v2(connection.handle(), sql.c_str(), -1, &prepared, nullptr);
  statement_.reset(prepared);
  check(code);
}

void SqliteStatement::check(int code) {
  if (code != SQLITE_OK) connection_.fail("cannot be read or written");
}

SqliteStatement& SqliteStatement::bind(int index, std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), index, value));
  return *this;
}

SqliteStatement& SqliteStatement::bind_text(int index, const std::string& text) {
  check(sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT,
                            SQLITE_UTF8));
  return *this;
}

SqliteStatement& SqliteStatement::bind_blob(int index, std::string_view blob) {
  // A null pointer would store NULL instead of a blob without bytes.
  check(sqlite3_bind_blob64(statement_.get(), index, blob.empty() ? "" : blob.data(), blob.size(),
                            SQLITE_TRANSIENT));
  return *this;
}

bool SqliteStatement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  connection_.fail("cannot be read or written");
}

void SqliteStatement::run() {
  while (step()) continue;
  check(sqlite3_reset(statement_.get()));
}

void SqliteStatement::require_type(int column, int type) const {
  if (sqlite3_column_type(statement_.get(), column) == type) return;
  throw std::runtime_error(fmt::format("{}: column {} has the wrong type", connection_.name(),
                                       sqlite3_column_name(statement_.get(), column)));
}

std::int64_t SqliteStatement::integer(int column) const {
  require_type(column, SQLITE_INTEGER);
  return sqlite3_column_int64(statement_.get(), column);
}

std::string SqliteStatement::text(int column) const {
  require_type(column, SQLITE_TEXT);
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::string_view SqliteStatement::blob(int column) const {
  require_type(column, SQLITE_BLOB);
  const void* data = sqlite3_column_blob(statement_.get(), column);
  if (data == nullptr) return {};
  return {static_cast<const char*>(data),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

SqliteTransaction::SqliteTransaction(SqliteConnection& connection, Kind kind)
    : connection_(connection) {
  connection_.execute(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN");
}

SqliteTransaction::~SqliteTransaction() {
  // Where SQLite has rolled back by itself (full disk) this reports an error that means nothing.
  if (open_) sqlite3_exec(connection_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void SqliteTransaction::commit() {
  connection_.execute("COMMIT");
  open_ = false;
}

}  // namespace topogeo::storage
