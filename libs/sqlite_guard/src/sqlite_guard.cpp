#include "topogeo/sqlite_guard/sqlite_guard.hpp"

#include <memory>

#include <sqlite3.h>

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::sqlite_guard {
namespace {

constexpr int kInstructions = 10'000;  // of SQLite's virtual machine, about 0.2 ms
// About 5 s on a small machine, and far more than reading a row of a sound file takes.
constexpr std::uint64_t kFreeSteps = 10'000;
constexpr std::uint64_t kInstructionsPerByte = 16;

/// The first row of a statement, as "WORD 'NAME'"; empty if there is none.
std::string first_row(sqlite3* database, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database, sql, -1, &raw, nullptr) != SQLITE_OK) return {};
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> row(raw, &sqlite3_finalize);
  if (sqlite3_step(raw) != SQLITE_ROW) return {};
  const auto text = [&](int column) {
    const auto* const bytes = reinterpret_cast<const char*>(sqlite3_column_text(raw, column));
    return std::string(bytes == nullptr ? "" : bytes);
  };
  constexpr std::size_t kMostShown = 60;
  return text(0) + " '" + text(1).substr(0, kMostShown) + "'";
}

}  // namespace

const char* const kTooMuchWork = "takes more work than an intact file of its size";

void refuse_irregular(const std::filesystem::path& path) {
  for (const char* part : {"", "-wal", "-shm", "-journal"}) {
    support::refuse_irregular(path.string() + part);
  }
}

std::uint64_t bytes_of(const std::filesystem::path& path) {
  std::uint64_t bytes = 0;
  for (const char* part : {"", "-wal"}) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path.string() + part, error);
    if (!error) bytes += size;
  }
  return bytes;
}

void protect(sqlite3* database) {
  const auto set = [database](int option, int value) {
    sqlite3_db_config(database, option, value, nullptr);
  };
  set(SQLITE_DBCONFIG_DEFENSIVE, 1);
  set(SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0);
  set(SQLITE_DBCONFIG_ENABLE_TRIGGER, 0);
  set(SQLITE_DBCONFIG_ENABLE_VIEW, 0);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, kLargestBlob);
}

std::string refused_schema(sqlite3* database) {
  std::string found = first_row(
      database,
      "SELECT CASE WHEN type IN ('view', 'trigger') THEN 'the ' || type ELSE 'the virtual table' "
      "END, name FROM sqlite_master WHERE type IN ('view', 'trigger') "
      "OR type = 'table' AND rootpage = 0 LIMIT 1");
  if (!found.empty()) return found;
  return first_row(database,
                   "SELECT 'the generated column', c.name FROM sqlite_master AS t, "
                   "pragma_table_xinfo(t.name) AS c "
                   "WHERE t.type = 'table' AND c.hidden IN (2, 3) LIMIT 1");
}

WorkLimit::WorkLimit(sqlite3* database, std::uint64_t file_bytes)
    : database_(database),
      steps_left_(kFreeSteps + file_bytes / kInstructions * kInstructionsPerByte) {
  sqlite3_progress_handler(database_, kInstructions, &WorkLimit::step, this);
}

WorkLimit::~WorkLimit() {
  sqlite3_progress_handler(database_, 0, nullptr, nullptr);
}

int WorkLimit::step(void* self) {
  auto& limit = *static_cast<WorkLimit*>(self);
  if (limit.steps_left_ > 0) --limit.steps_left_;
  return limit.steps_left_ == 0 ? 1 : 0;
}

}  // namespace topogeo::sqlite_guard
