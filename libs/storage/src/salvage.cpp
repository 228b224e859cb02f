#include "topogeo/storage/salvage.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include "topogeo/sqlite_guard/sqlite_guard.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"
#include "topogeo/support/temporary_folder.hpp"

#include "table_writer.hpp"

namespace topogeo::storage {
namespace {

namespace fs = std::filesystem;

/// A copy of the file and its write-ahead log in a temporary folder, removed with the object.
class SalvageCopy {
 public:
  explicit SalvageCopy(const fs::path& path) {
    sqlite_guard::refuse_irregular(path);
    if (const std::uint64_t bytes = sqlite_guard::bytes_of(path); bytes > support::kMostMapBytes) {
      throw std::runtime_error(fmt::format("{}: is {} bytes, expected at most {}", path.string(),
                                           bytes, support::kMostMapBytes));
    }
    fs::copy_file(path, file());
    const fs::path log = path.string() + "-wal";
    if (fs::exists(log)) fs::copy_file(log, file().string() + "-wal");
  }

  [[nodiscard]] fs::path file() const { return folder_.path() / "map.sqlite"; }

 private:
  support::TemporaryFolder folder_{"repair"};
};

SalvagedRow row_of(SQLite::Statement& statement) {
  SalvagedRow row;
  for (int i = 0; i < statement.getColumnCount(); ++i) {
    const SQLite::Column column = statement.getColumn(i);
    const std::string name = statement.getColumnName(i);
    if (column.isInteger()) {
      row.numbers[name] = column.getInt64();
    } else if (column.isText() || column.isBlob()) {
      row.texts[name] = column.getString();
    }
  }
  return row;
}

bool is_sound(const SalvagedRow& row) {
  const auto hash = row.numbers.find("blob_hash");
  if (hash == row.numbers.end()) return true;
  const auto blob = row.texts.find("blob");
  const std::string_view bytes = blob == row.texts.end() ? "" : std::string_view(blob->second);
  return as_unsigned(hash->second) == support::fnv1a(bytes);
}

/// Reads rows in one direction up to the first unreadable one or one of `known`; returns false in
/// the first case. More than `most_bytes` means shared pages, which is damage, too.
bool read_rows(SQLite::Database& database, const std::string& table, const char* order,
               std::uint64_t most_bytes, std::set<std::int64_t>& known, SalvagedTable& out) {
  std::vector<SalvagedRow> rows;
  bool complete = true;
  std::uint64_t bytes = 0;
  try {
    SQLite::Statement statement(
        database,
        fmt::format("SELECT rowid AS row_number, * FROM \"{}\" ORDER BY rowid {}", table, order));
    while (statement.executeStep()) {
      SalvagedRow row = row_of(statement);
      for (const auto& [column, text] : row.texts) bytes += text.size();
      if (bytes > most_bytes) {
        complete = false;
        break;
      }
      if (!known.insert(row.numbers["row_number"]).second) break;
      rows.push_back(std::move(row));
    }
  } catch (const SQLite::Exception&) {
    complete = false;
  }
  for (SalvagedRow& row : rows) {
    if (is_sound(row)) {
      out.rows.push_back(std::move(row));
    } else {
      ++out.damaged_blobs;
    }
  }
  return complete;
}

SalvagedTable read_salvaged_table(SQLite::Database& database, const std::string& table,
                                  std::uint64_t most_bytes) {
  SalvagedTable out;
  std::set<std::int64_t> known;
  out.complete = read_rows(database, table, "ASC", most_bytes, known, out);
  if (!out.complete) read_rows(database, table, "DESC", most_bytes, known, out);
  return out;
}

/// Keys and values, because such a table has no row numbers.
SalvagedTable read_meta_rows(SQLite::Database& database) {
  SalvagedTable out;
  try {
    SQLite::Statement statement(database, "SELECT * FROM meta");
    while (statement.executeStep()) out.rows.push_back(row_of(statement));
  } catch (const SQLite::Exception&) {
    out.complete = false;
  }
  return out;
}

}  // namespace

std::map<std::string, SalvagedTable> salvage_tables(const fs::path& path) {
  const SalvageCopy copy(path);
  std::map<std::string, SalvagedTable> tables;
  try {
    SQLite::Database database(copy.file().string(), SQLite::OPEN_READWRITE);
    sqlite_guard::protect(database.getHandle());
    const std::uint64_t bytes = sqlite_guard::bytes_of(copy.file());
    const sqlite_guard::WorkLimit limit(database.getHandle(), bytes);
    std::vector<std::string> names;
    SQLite::Statement statement(
        database, "SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage > 0");
    while (statement.executeStep()) names.push_back(statement.getColumn(0).getString());
    for (const std::string& name : names) {
      tables[name] =
          name == "meta" ? read_meta_rows(database) : read_salvaged_table(database, name, bytes);
    }
  } catch (const SQLite::Exception& error) {
    throw std::runtime_error(
        fmt::format("{}: nothing can be read: {}", path.string(), error.what()));
  }
  return tables;
}

}  // namespace topogeo::storage
