#include "map_schema.hpp"

#include <array>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/Statement.h>

#include "topogeo/sqlite_guard/sqlite_guard.hpp"
#include "topogeo/storage/map_database.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"

#include "map_rows.hpp"
#include "meta_table.hpp"
#include "sqlite_rows.hpp"

namespace topogeo::storage {
namespace {

constexpr std::int64_t kApplicationId = 0x54474D50;  // "TGMP": marks the file for `file` and us
constexpr int kBusyTimeout_ms = 5000;                // wait for another program's transaction

// Every blob has the hash of its bytes beside it, because SQLite itself does not notice a changed
// byte inside a blob. Ids of sessions and hashes have 64 bits and are stored as signed numbers.
constexpr const char* kSchema = R"(
  CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
  CREATE TABLE session(
    place INTEGER PRIMARY KEY, id INTEGER NOT NULL UNIQUE, kept_from INTEGER NOT NULL,
    is_over INTEGER NOT NULL);
  CREATE TABLE stop(
    session INTEGER NOT NULL REFERENCES session(id), number INTEGER NOT NULL,
    stamp_ns INTEGER NOT NULL, content_hash INTEGER NOT NULL,
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL,
    PRIMARY KEY(session, number));
  CREATE TABLE map_stop(
    id INTEGER PRIMARY KEY, session INTEGER NOT NULL, number INTEGER NOT NULL,
    starts_drive INTEGER NOT NULL,
    UNIQUE(session, number),
    FOREIGN KEY(session, number) REFERENCES stop(session, number));
  CREATE TABLE stop_pose(
    id INTEGER PRIMARY KEY REFERENCES map_stop(id), version INTEGER NOT NULL,
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE loop_closure(
    id INTEGER PRIMARY KEY,
    earlier_id INTEGER NOT NULL REFERENCES map_stop(id),
    later_id INTEGER NOT NULL REFERENCES map_stop(id),
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE edge(
    id INTEGER PRIMARY KEY,
    earlier_id INTEGER NOT NULL REFERENCES map_stop(id),
    later_id INTEGER NOT NULL REFERENCES map_stop(id),
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE map_node(id INTEGER PRIMARY KEY, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE map_branch(
    id INTEGER PRIMARY KEY,
    node_a INTEGER NOT NULL REFERENCES map_node(id) DEFERRABLE INITIALLY DEFERRED,
    node_b INTEGER NOT NULL REFERENCES map_node(id) DEFERRABLE INITIALLY DEFERRED,
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE INDEX map_branch_node_a ON map_branch(node_a);
  CREATE INDEX map_branch_node_b ON map_branch(node_b);
  CREATE TABLE place(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE zone(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, kind TEXT NOT NULL,
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE drawn_grid(id INTEGER PRIMARY KEY, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
)";

// New in version 3: the numbered rooms and the places in them.
constexpr const char* kRoomTables = R"(
  CREATE TABLE room(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE room_place(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
)";

// New in version 4: walls, openings and doors that people draw.
constexpr const char* kDrawnLineTable = R"(
  CREATE TABLE drawn_line(
    id INTEGER PRIMARY KEY, kind TEXT NOT NULL, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
)";

std::int64_t pragma(SQLite::Database& database, const char* name) {
  const SQLite::Column value = database.execAndGet(fmt::format("PRAGMA {}", name));
  return value.getInt64();
}

/// Throws unless the file is missing, empty or starts like an SQLite file. SQLite itself treats a
/// file shorter than its smallest page as empty and would overwrite it.
void check_file_start(const std::filesystem::path& path) {
  constexpr std::string_view kSqliteStart("SQLite format 3\0", 16);
  constexpr std::uintmax_t kSmallestFile = 512;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size == 0) return;  // opening the file reports the error
  if (support::first_bytes(path, kSqliteStart.size()) != kSqliteStart) {
    throw std::runtime_error(path.string() + ": not a map database (no SQLite file)");
  }
  if (size < kSmallestFile) {
    throw std::runtime_error(fmt::format("{}: cut short to {} bytes", path.string(), size));
  }
}

/// The file's URI with which SQLite treats it as immutable. Without a log the file is complete, and
/// SQLite then leaves no files beside it.
std::string immutable_uri(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

std::unique_ptr<SQLite::Database> open_file(const std::filesystem::path& path, Access access) {
  switch (access) {
    case Access::kCreate:
      return std::make_unique<SQLite::Database>(
          path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kBusyTimeout_ms);
    case Access::kExisting:
      return std::make_unique<SQLite::Database>(path.string(), SQLite::OPEN_READWRITE,
                                                kBusyTimeout_ms);
    case Access::kReadOnly:
      break;
  }
  for (const char* beside : {"-wal", "-journal"}) {
    if (!std::filesystem::exists(path.string() + beside)) continue;
    return std::make_unique<SQLite::Database>(path.string(), SQLite::OPEN_READONLY,
                                              kBusyTimeout_ms);
  }
  return std::make_unique<SQLite::Database>(
      immutable_uri(path), SQLite::OPEN_READONLY | SQLite::OPEN_URI, kBusyTimeout_ms);
}

}  // namespace

std::unique_ptr<SQLite::Database> open_map_database(const std::filesystem::path& path,
                                                    Access access) {
  sqlite_guard::refuse_irregular(path);
  check_file_start(path);
  auto database = open_file(path, access);
  sqlite_guard::protect(database->getHandle());
  const sqlite_guard::WorkLimit limit(database->getHandle(), sqlite_guard::bytes_of(path));
  // The first read detects whether this is an SQLite file at all.
  const std::int64_t application_id = pragma(*database, "application_id");
  const bool is_new = !has_content(*database);
  if (is_new ? access != Access::kCreate : application_id != kApplicationId) {
    throw std::runtime_error(path.string() +
                             (is_new ? ": empty, expected a topogeo map database"
                                     : ": an SQLite file, but no topogeo map database"));
  }
  const std::int64_t version = stored_version(*database);
  if (!is_new && (version < 1 || version > MapDatabase::kSchemaVersion)) {
    throw std::runtime_error(fmt::format("{}: map database version {}, this program reads 1 to {}",
                                         path.string(), version, MapDatabase::kSchemaVersion));
  }
  if (const std::string refused = sqlite_guard::refused_schema(database->getHandle());
      !refused.empty()) {
    throw std::runtime_error(path.string() + ": has " + refused +
                             ", expected only the tables of a map");
  }
  database->exec("PRAGMA cell_size_check=ON; PRAGMA foreign_keys=ON");
  if (access != Access::kReadOnly) {
    database->exec("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL");
  }
  return database;
}

bool has_content(SQLite::Database& database) {
  return pragma(database, "schema_version") != 0;
}

std::int64_t stored_version(SQLite::Database& database) {
  return pragma(database, "user_version");
}

std::unique_ptr<SQLite::Database> copy_in_memory(SQLite::Database& database) {
  auto copy =
      std::make_unique<SQLite::Database>(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  SQLite::Backup backup(*copy, database);
  backup.executeStep(-1);
  return copy;
}

void create_tables(SQLite::Database& database, const std::string& robot_id, std::uint64_t seed) {
  database.exec(kSchema);
  database.exec(kRoomTables);
  database.exec(kDrawnLineTable);
  database.exec(fmt::format("PRAGMA application_id={}; PRAGMA user_version={}", kApplicationId,
                            MapDatabase::kSchemaVersion));
  write_meta(database, "robot_id", robot_id);
  write_meta(database, "seed", std::to_string(seed));
  for (const char* number : {"map_id", "trajectory_version", "global_map_version"}) {
    write_meta(database, number, "0");
  }
}

void make_version_3_of_2(SQLite::Database& database) {
  database.exec(kRoomTables);
  database.exec("PRAGMA user_version=3");
}

void make_version_4_of_3(SQLite::Database& database) {
  database.exec(kDrawnLineTable);
  database.exec("PRAGMA user_version=4");
}

MapDocument take_version_1(SQLite::Database& database) {
  const std::string& file = database.getFilename();
  MapDocument document;
  document.robot_id = read_meta(database, "robot_id");
  document.seed = read_meta_number(database, "seed");
  document.trajectory.version = read_meta_number(database, "trajectory_version");
  document.global_map.version = read_meta_number(database, "global_map_version");
  read_table<proto::LocalMap>(database, file, "local_map", document.local_maps);
  read_table<proto::StopPose>(database, file, "stop_pose", document.trajectory.stops);
  read_table<proto::LoopClosure>(database, file, "loop_closure", document.loop_closures);
  read_table<proto::MapNode>(database, file, "map_node", document.global_map.nodes);
  read_table<proto::MapBranch>(database, file, "map_branch", document.global_map.branches);
  if (database.tableExists("drawing")) {  // made with the first drawing
    std::vector<MapDrawing> drawings;
    read_table<proto::Drawing>(database, file, "drawing", drawings);
    if (!drawings.empty()) document.drawing = std::move(drawings.front());
    database.exec("DROP TABLE drawing");
  }
  for (const char* table :
       {"map_branch", "map_node", "loop_closure", "stop_pose", "local_map", "meta"}) {
    database.exec(fmt::format("DROP TABLE {}", table));
  }
  return document;
}

}  // namespace topogeo::storage
