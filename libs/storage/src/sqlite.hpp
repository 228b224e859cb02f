// SQLite connection, prepared statement and transaction that clean up after themselves and throw
// std::runtime_error naming the file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <sqlite3.h>

namespace topogeo::storage {

class SqliteConnection {
 public:
  /// `name` stands for the file in messages.
  SqliteConnection(const std::string& path, bool may_create);

  /// Runs statements that give no rows.
  void execute(const char* sql);

  [[noreturn]] void fail(std::string_view doing) const;
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };
  std::string name_;
  std::unique_ptr<sqlite3, Close> handle_;
};

class SqliteStatement {
 public:
  SqliteStatement(SqliteConnection& connection, const std::string& sql);

  /// Parameters count from 1; texts and blobs are copied.
  SqliteStatement& bind(int index, std::int64_t value);
  SqliteStatement& bind_text(int index, const std::string& text);
  SqliteStatement& bind_blob(int index, std::string_view blob);

  /// The next row; false after the last.
  bool step();
  /// Runs to the end and makes the statement ready for other parameters.
  void run();

  /// Columns count from 0. They throw when the column is not of that type.
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::string_view blob(int column) const;  ///< valid until the next step

 private:
  void check(int code);
  void require_type(int column, int type) const;

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  SqliteConnection& connection_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// Rolled back at the end of its life unless committed.
class SqliteTransaction {
 public:
  enum class Kind : std::uint8_t {
    kRead,   ///< all reads see one state
    kWrite,  ///< waits for other writers now rather than half-way
  };
  SqliteTransaction(SqliteConnection& connection, Kind kind);
  SqliteTransaction(const SqliteTransaction&) = delete;
  SqliteTransaction& operator=(const SqliteTransaction&) = delete;
  ~SqliteTransaction();
  void commit();

 private:
  SqliteConnection& connection_;
  bool open_ = true;
};

}  // namespace topogeo::storage
