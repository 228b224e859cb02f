#include "sqlite_sink.hpp"

#include <stdexcept>

#include <sqlite3.h>

namespace topogeo::recording {

SqliteSink::SqliteSink(const std::filesystem::path& path)
    : name_(path.string()),
      database_(nullptr, &sqlite3_close),
      insert_topic_(nullptr, &sqlite3_finalize),
      insert_message_(nullptr, &sqlite3_finalize) {
  std::filesystem::remove(path);
  sqlite3* raw = nullptr;
  const int opened =
      sqlite3_open_v2(name_.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  database_.reset(raw);
  check(opened == SQLITE_OK);
  // Uses one transaction: an interruption leaves an empty recording and a journal, which SQLite
  // resolves.
  execute(
      "PRAGMA synchronous = OFF;"
      "BEGIN;"
      "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
      "INSERT INTO schema VALUES(3, 'humble');"
      "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL,"
      " metadata TEXT NOT NULL);"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
      " timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  const auto prepare = [&](const char* sql) {
    sqlite3_stmt* statement = nullptr;
    check(sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) == SQLITE_OK);
    return statement;
  };
  insert_topic_.reset(prepare("INSERT INTO topics VALUES(NULL, ?, ?, 'cdr', ?)"));
  insert_message_.reset(prepare("INSERT INTO messages VALUES(NULL, ?, ?, ?)"));
}

SqliteSink::~SqliteSink() = default;

void SqliteSink::check(bool good) {
  if (good) return;
  throw std::runtime_error(
      name_ + ": cannot write: " + (database_ ? sqlite3_errmsg(database_.get()) : "no memory"));
}

void SqliteSink::execute(const char* sql) {
  check(sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) == SQLITE_OK);
}

std::int64_t SqliteSink::topic_of(const OutputMessage& message) {
  const auto known = topics_.find(message.topic);
  if (known != topics_.end()) return known->second;
  sqlite3_stmt* row = insert_topic_.get();
  const std::string type(message.type);
  const std::string profile = qos_profile_text(is_latched(message.topic));
  sqlite3_bind_text(row, 1, message.topic.c_str(), -1, SQLITE_TRANSIENT);
  sqlite3_bind_text(row, 2, type.c_str(), -1, SQLITE_TRANSIENT);
  sqlite3_bind_text(row, 3, profile.c_str(), -1, SQLITE_TRANSIENT);
  check(sqlite3_step(row) == SQLITE_DONE);
  sqlite3_reset(row);
  return topics_.emplace(message.topic, sqlite3_last_insert_rowid(database_.get())).first->second;
}

void SqliteSink::write(const OutputMessage& message) {
  const std::int64_t topic = topic_of(message);
  sqlite3_stmt* row = insert_message_.get();
  sqlite3_bind_int64(row, 1, topic);
  sqlite3_bind_int64(row, 2, message.time_ns);
  sqlite3_bind_blob64(row, 3, message.data.data(), message.data.size(), SQLITE_STATIC);
  check(sqlite3_step(row) == SQLITE_DONE);
  sqlite3_reset(row);
}

void SqliteSink::close() {
  execute("COMMIT");
  insert_topic_.reset();
  insert_message_.reset();
  check(sqlite3_close(database_.release()) == SQLITE_OK);
}

}  // namespace topogeo::recording
