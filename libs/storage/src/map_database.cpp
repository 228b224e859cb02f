#include "topogeo/storage/map_database.hpp"

#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"
#include "meta_table.hpp"
#include "sqlite_rows.hpp"
#include "table_writer.hpp"

namespace topogeo::storage {
namespace {

constexpr std::int64_t kApplicationId = 0x54474D50;  // "TGMP": marks the file for `file` and us
constexpr std::int64_t kSchemaVersion = 1;
constexpr int kBusyTimeout_ms = 5000;  // for another program to finish its transaction

// One file is one robot's run, so the robot id stands once in meta. Every blob has the hash of its
// bytes beside it, because SQLite itself does not notice a changed byte inside a blob.
constexpr const char* kSchema = R"(
  CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
  CREATE TABLE local_map(
    id INTEGER PRIMARY KEY, stamp_ns INTEGER NOT NULL, content_hash INTEGER NOT NULL,
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE stop_pose(
    id INTEGER PRIMARY KEY REFERENCES local_map(id),
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE loop_closure(
    id INTEGER PRIMARY KEY,
    earlier_id INTEGER NOT NULL REFERENCES local_map(id),
    later_id INTEGER NOT NULL REFERENCES local_map(id),
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE map_node(id INTEGER PRIMARY KEY, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE TABLE map_branch(
    id INTEGER PRIMARY KEY,
    node_a INTEGER NOT NULL REFERENCES map_node(id) DEFERRABLE INITIALLY DEFERRED,
    node_b INTEGER NOT NULL REFERENCES map_node(id) DEFERRABLE INITIALLY DEFERRED,
    blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
  CREATE INDEX map_branch_node_a ON map_branch(node_a);
  CREATE INDEX map_branch_node_b ON map_branch(node_b);
)";

// Made with the first drawing: databases without one do not have it.
constexpr const char* kDrawingSchema =
    "CREATE TABLE IF NOT EXISTS drawing("
    "id INTEGER PRIMARY KEY, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL)";

std::int64_t pragma(SQLite::Database& database, const char* name) {
  const SQLite::Column value = database.execAndGet(fmt::format("PRAGMA {}", name));
  return value.getInt64();
}

/// Throws unless the file is missing, empty or starts like an SQLite file. SQLite itself takes a
/// file shorter than its smallest page for an empty one and would overwrite it.
void check_file_start(const std::filesystem::path& path) {
  constexpr std::string_view kStart("SQLite format 3\0", 16);
  constexpr std::uintmax_t kSmallestFile = 512;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size == 0) return;  // opening the file reports the error
  std::string start(kStart.size(), '\0');
  std::ifstream(path, std::ios::binary)
      .read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start != kStart) {
    throw std::runtime_error(path.string() + ": not a map database (no SQLite file)");
  }
  if (size < kSmallestFile) {
    throw std::runtime_error(fmt::format("{}: cut short to {} bytes", path.string(), size));
  }
}

/// Parses the blob of the statement's row: columns id, blob_hash, blob.
template <typename Message>
auto parse_row(const SQLite::Statement& row, const std::string& name, const char* table) {
  const std::string_view blob = blob_at(row, 2);
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(
        fmt::format("{}: {} {} is damaged ({})", name, table, integer_at(row, 0), why));
  };
  if (as_unsigned(integer_at(row, 1)) != support::fnv1a(blob)) fail("its hash is wrong");
  Message message;
  if (!message.ParseFromArray(blob.data(), static_cast<int>(blob.size()))) {
    fail("no valid Protobuf message");
  }
  try {
    return from_proto(message);
  } catch (const std::runtime_error& error) {
    fail(error.what());
    throw;
  }
}

template <typename Message, typename Value>
void read_table(SQLite::Database& database, const char* table, std::vector<Value>& values) {
  SQLite::Statement row(database,
                        fmt::format("SELECT id, blob_hash, blob FROM {} ORDER BY id", table));
  while (row.executeStep()) {
    values.push_back(parse_row<Message>(row, database.getFilename(), table));
  }
}

}  // namespace

MapDatabase::MapDatabase(MapDatabase&&) noexcept = default;
MapDatabase& MapDatabase::operator=(MapDatabase&&) noexcept = default;
MapDatabase::~MapDatabase() = default;

MapDatabase::MapDatabase(const std::filesystem::path& path, bool may_create)
    : name_(path.string()) {
  check_file_start(path);
  const int flags = SQLite::OPEN_READWRITE | (may_create ? SQLite::OPEN_CREATE : 0);
  database_ = std::make_unique<SQLite::Database>(name_, flags, kBusyTimeout_ms);
  // The first read finds out whether this is an SQLite file at all.
  const std::int64_t application_id = pragma(*database_, "application_id");
  const std::int64_t version = pragma(*database_, "user_version");
  const bool is_new = pragma(*database_, "schema_version") == 0;
  if (is_new ? !may_create : application_id != kApplicationId) {
    throw std::runtime_error(name_ + (is_new ? ": empty, expected a topogeo map database"
                                             : ": an SQLite file, but no topogeo map database"));
  }
  if (!is_new && version != kSchemaVersion) {
    throw std::runtime_error(fmt::format("{}: map database version {}, this program reads {}",
                                         name_, version, kSchemaVersion));
  }
  database_->exec("PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; PRAGMA foreign_keys=ON");
}

MapDatabase MapDatabase::open_or_create(const std::filesystem::path& path,
                                        const std::string& robot_id, std::uint64_t seed) try {
  MapDatabase database(path, true);
  if (pragma(*database.database_, "schema_version") == 0) {
    database.create_schema(robot_id, seed);
  }
  database.read_state();
  if (database.robot_id_ != robot_id || database.seed_ != seed) {
    throw std::runtime_error(
        fmt::format("{}: holds the map of robot '{}' with seed {}, expected '{}' with seed {}",
                    path.string(), database.robot_id_, database.seed_, robot_id, seed));
  }
  return database;
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

MapDatabase MapDatabase::open_existing(const std::filesystem::path& path) try {
  MapDatabase database(path, false);
  database.read_state();
  return database;
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

void MapDatabase::check_replaceable(const std::filesystem::path& path) try {
  static_cast<void>(MapDatabase(path, true));
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

void MapDatabase::create_schema(const std::string& robot_id, std::uint64_t seed) {
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  database_->exec(kSchema);
  database_->exec(fmt::format("PRAGMA application_id={}; PRAGMA user_version={}", kApplicationId,
                              kSchemaVersion)
                      .c_str());
  write_meta(*database_, "robot_id", robot_id);
  write_meta(*database_, "seed", std::to_string(seed));
  write_meta(*database_, "trajectory_version", "0");
  write_meta(*database_, "global_map_version", "0");
  transaction.commit();
}

void MapDatabase::read_hashes(const char* table, BlobHashes& hashes) {
  SQLite::Statement row(*database_, fmt::format("SELECT id, blob_hash FROM {}", table));
  while (row.executeStep()) {
    hashes[static_cast<std::uint32_t>(integer_at(row, 0))] = as_unsigned(integer_at(row, 1));
  }
}

void MapDatabase::read_state() {
  // Finds a file that was cut short now instead of at some later read.
  SQLite::Statement check(*database_, "PRAGMA quick_check(1)");
  const std::string verdict = check.executeStep() ? text_at(check, 0) : "no answer";
  if (verdict != "ok") {
    throw std::runtime_error(fmt::format("{}: cut short or damaged ({})", name_, verdict));
  }
  robot_id_ = read_meta(*database_, "robot_id");
  seed_ = read_meta_number(*database_, "seed");
  trajectory_version_ = read_meta_number(*database_, "trajectory_version");
  SQLite::Statement count(*database_, "SELECT count(*) FROM local_map");
  count.executeStep();
  local_map_count_ = static_cast<std::uint32_t>(integer_at(count, 0));
  read_hashes("stop_pose", stop_hashes_);
  read_hashes("loop_closure", closure_hashes_);
  read_hashes("map_node", node_hashes_);
  read_hashes("map_branch", branch_hashes_);
}

void MapDatabase::put_local_map(const topomap::LocalMap& map) try {
  if (map.robot_id != robot_id_ || map.id > local_map_count_) {
    throw std::invalid_argument(
        fmt::format("{}: local map {} of robot '{}', expected at most {} of robot '{}'", name_,
                    map.id, map.robot_id, local_map_count_, robot_id_));
  }
  const std::string blob = to_blob<proto::LocalMap>(map);
  const std::int64_t blob_hash = as_signed(support::fnv1a(blob));
  if (map.id < local_map_count_) {
    SQLite::Statement stored(*database_, "SELECT blob_hash FROM local_map WHERE id = ?");
    stored.bind(1, map.id);
    if (stored.executeStep() && integer_at(stored, 0) == blob_hash) return;
    throw std::invalid_argument(
        fmt::format("{}: already holds another local map {}", name_, map.id));
  }
  SQLite::Statement insert(*database_,
                           "INSERT INTO local_map(id, stamp_ns, content_hash, blob_hash, blob) "
                           "VALUES(?, ?, ?, ?, ?)");
  insert.bind(1, map.id);
  insert.bind(2, map.stamp_ns);
  insert.bind(3, as_signed(topomap::content_hash(map)));
  insert.bind(4, blob_hash);
  bind_blob(insert, 5, blob);
  insert.exec();
  ++local_map_count_;
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

void MapDatabase::put_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                                 std::span<const topomap::LoopClosure> closures) try {
  if (version < trajectory_version_) {
    throw std::invalid_argument(
        fmt::format("{}: trajectory version {} after {}", name_, version, trajectory_version_));
  }
  for (const topomap::StopPose& stop : changed) {
    if (stop.local_map_id >= local_map_count_) {
      throw std::invalid_argument(
          fmt::format("{}: stop {} has no local map yet", name_, stop.local_map_id));
    }
  }
  for (const topomap::LoopClosure& c : closures) {
    if (c.earlier_id >= c.later_id || c.later_id >= local_map_count_) {
      throw std::invalid_argument(
          fmt::format("{}: loop closure from {} to {}: expected ids below {}", name_, c.earlier_id,
                      c.later_id, local_map_count_));
    }
  }
  BlobHashes stop_hashes = stop_hashes_;
  BlobHashes closure_hashes = closure_hashes_;
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  TableWriter stop_writer(*database_, "stop_pose");
  for (const topomap::StopPose& stop : changed) {
    stop_writer.put(stop_hashes, stop.local_map_id, to_blob<proto::StopPose>(stop));
  }
  // The place in the list is the id, so that reading gives back the caller's order.
  TableWriter closure_writer(*database_, "loop_closure", ", earlier_id, later_id", ", ?, ?");
  for (std::size_t i = 0; i < closures.size(); ++i) {
    closure_writer.put(closure_hashes, static_cast<std::uint32_t>(i),
                       to_blob<proto::LoopClosure>(closures[i]),
                       {closures[i].earlier_id, closures[i].later_id});
  }
  closure_writer.remove_others(closure_hashes,
                               [&](std::uint32_t id) { return id < closures.size(); });
  write_meta(*database_, "trajectory_version", std::to_string(version));
  transaction.commit();
  trajectory_version_ = version;
  stop_hashes_ = std::move(stop_hashes);
  closure_hashes_ = std::move(closure_hashes);
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

void MapDatabase::put_global_map(const topomap::GlobalMap& map) try {
  try {
    check_global_map(map);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(fmt::format("{}: global map: {}", name_, error.what()));
  }
  BlobHashes node_hashes = node_hashes_;
  BlobHashes branch_hashes = branch_hashes_;
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  TableWriter node_writer(*database_, "map_node");
  std::map<std::uint32_t, bool> kept;
  for (const topomap::MapNode& node : map.nodes) {
    node_writer.put(node_hashes, node.id, to_blob<proto::MapNode>(node));
    kept[node.id] = true;
  }
  node_writer.remove_others(node_hashes, [&](std::uint32_t id) { return kept.contains(id); });
  TableWriter branch_writer(*database_, "map_branch", ", node_a, node_b", ", ?, ?");
  kept.clear();
  for (const topomap::MapBranch& branch : map.branches) {
    branch_writer.put(branch_hashes, branch.id, to_blob<proto::MapBranch>(branch),
                      {branch.node_a, branch.node_b});
    kept[branch.id] = true;
  }
  branch_writer.remove_others(branch_hashes, [&](std::uint32_t id) { return kept.contains(id); });
  write_meta(*database_, "global_map_version", std::to_string(map.version));
  transaction.commit();
  node_hashes_ = std::move(node_hashes);
  branch_hashes_ = std::move(branch_hashes);
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

void MapDatabase::put_drawing(const MapDrawing& drawing) try {
  try {
    check(drawing);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(fmt::format("{}: {}", name_, error.what()));
  }
  const std::string blob = to_blob<proto::Drawing>(drawing);
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  database_->exec(kDrawingSchema);
  BlobHashes none_stored;
  TableWriter(*database_, "drawing").put(none_stored, 0, blob);
  transaction.commit();
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

MapDocument MapDatabase::load() const try {
  const SQLite::Transaction one_state(*database_, SQLite::TransactionBehavior::DEFERRED);
  MapDocument document;
  document.robot_id = robot_id_;
  document.seed = seed_;
  read_table<proto::LocalMap>(*database_, "local_map", document.local_maps);
  document.trajectory.version = read_meta_number(*database_, "trajectory_version");
  read_table<proto::StopPose>(*database_, "stop_pose", document.trajectory.stops);
  read_table<proto::LoopClosure>(*database_, "loop_closure", document.loop_closures);
  document.global_map.version = read_meta_number(*database_, "global_map_version");
  read_table<proto::MapNode>(*database_, "map_node", document.global_map.nodes);
  read_table<proto::MapBranch>(*database_, "map_branch", document.global_map.branches);
  if (database_->tableExists("drawing")) {
    std::vector<MapDrawing> drawings;
    read_table<proto::Drawing>(*database_, "drawing", drawings);
    if (!drawings.empty()) document.drawing = std::move(drawings.front());
  }
  try {
    check_document(document);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: damaged ({})", name_, error.what()));
  }
  return document;
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

}  // namespace topogeo::storage
