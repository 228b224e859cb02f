#include "topogeo/storage/map_database.hpp"

#include <bit>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"
#include "meta_table.hpp"
#include "sqlite.hpp"

namespace topogeo::storage {
namespace {

constexpr std::int64_t kApplicationId = 0x54474D50;  // "TGMP": marks the file for `file` and us
constexpr std::int64_t kSchemaVersion = 1;

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

std::int64_t as_signed(std::uint64_t value) {
  return std::bit_cast<std::int64_t>(value);
}
std::uint64_t as_unsigned(std::int64_t value) {
  return std::bit_cast<std::uint64_t>(value);
}

std::int64_t pragma(SqliteConnection& connection, const char* name) {
  SqliteStatement statement(connection, fmt::format("PRAGMA {}", name));
  return statement.step() ? statement.integer(0) : 0;
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
auto parse_row(const SqliteStatement& row, const std::string& name, const char* table) {
  const std::string_view blob = row.blob(2);
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(
        fmt::format("{}: {} {} is damaged ({})", name, table, row.integer(0), why));
  };
  if (as_unsigned(row.integer(1)) != support::fnv1a(blob)) fail("its hash is wrong");
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
void read_table(SqliteConnection& connection, const char* table, std::vector<Value>& values) {
  SqliteStatement row(connection,
                      fmt::format("SELECT id, blob_hash, blob FROM {} ORDER BY id", table));
  while (row.step()) values.push_back(parse_row<Message>(row, connection.name(), table));
}

/// Upserts of one table: only blobs whose hash differs from the stored one are written.
class TableWriter {
 public:
  TableWriter(SqliteConnection& connection, const std::string& table,
              const std::string& extra_columns, const std::string& extra_parameters)
      : connection_(connection),
        table_(table),
        upsert_(connection,
                fmt::format("INSERT OR REPLACE INTO {}(id, blob_hash, blob{}) VALUES(?, ?, ?{})",
                            table, extra_columns, extra_parameters)) {}

  /// `extra` are the values of the extra columns.
  void put(std::map<std::uint32_t, std::uint64_t>& hashes, std::uint32_t id,
           const std::string& blob, std::initializer_list<std::int64_t> extra = {}) {
    const std::uint64_t hash = support::fnv1a(blob);
    const auto [entry, is_new] = hashes.try_emplace(id, hash);
    if (!is_new && entry->second == hash) return;
    entry->second = hash;
    upsert_.bind(1, id).bind(2, as_signed(hash)).bind_blob(3, blob);
    int index = 4;
    for (const std::int64_t value : extra) upsert_.bind(index++, value);
    upsert_.run();
  }

  template <typename IsKept>
  void remove_others(std::map<std::uint32_t, std::uint64_t>& hashes, const IsKept& is_kept) {
    SqliteStatement remove(connection_, fmt::format("DELETE FROM {} WHERE id = ?", table_));
    std::erase_if(hashes, [&](const auto& entry) {
      if (is_kept(entry.first)) return false;
      remove.bind(1, entry.first).run();
      return true;
    });
  }

 private:
  SqliteConnection& connection_;
  std::string table_;
  SqliteStatement upsert_;
};

}  // namespace

MapDatabase::MapDatabase(MapDatabase&&) noexcept = default;
MapDatabase& MapDatabase::operator=(MapDatabase&&) noexcept = default;
MapDatabase::~MapDatabase() = default;

MapDatabase::MapDatabase(const std::filesystem::path& path, bool may_create)
    : name_(path.string()) {
  check_file_start(path);
  connection_ = std::make_unique<SqliteConnection>(name_, may_create);
  // The first read finds out whether this is an SQLite file at all.
  const std::int64_t application_id = pragma(*connection_, "application_id");
  const std::int64_t version = pragma(*connection_, "user_version");
  const bool is_new = pragma(*connection_, "schema_version") == 0;
  if (is_new ? !may_create : application_id != kApplicationId) {
    throw std::runtime_error(name_ + (is_new ? ": empty, expected a topogeo map database"
                                             : ": an SQLite file, but no topogeo map database"));
  }
  if (!is_new && version != kSchemaVersion) {
    throw std::runtime_error(fmt::format("{}: map database version {}, this program reads {}",
                                         name_, version, kSchemaVersion));
  }
  connection_->execute(
      "PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; PRAGMA foreign_keys=ON");
}

MapDatabase MapDatabase::open_or_create(const std::filesystem::path& path,
                                        const std::string& robot_id, std::uint64_t seed) {
  MapDatabase database(path, true);
  if (pragma(*database.connection_, "schema_version") == 0) {
    database.create_schema(robot_id, seed);
  }
  database.read_state();
  if (database.robot_id_ != robot_id || database.seed_ != seed) {
    throw std::runtime_error(
        fmt::format("{}: holds the map of robot '{}' with seed {}, expected '{}' with seed {}",
                    path.string(), database.robot_id_, database.seed_, robot_id, seed));
  }
  return database;
}

MapDatabase MapDatabase::open_existing(const std::filesystem::path& path) {
  MapDatabase database(path, false);
  database.read_state();
  return database;
}

void MapDatabase::check_replaceable(const std::filesystem::path& path) {
  static_cast<void>(MapDatabase(path, true));
}

void MapDatabase::create_schema(const std::string& robot_id, std::uint64_t seed) {
  SqliteTransaction transaction(*connection_, SqliteTransaction::Kind::kWrite);
  connection_->execute(kSchema);
  connection_->execute(fmt::format("PRAGMA application_id={}; PRAGMA user_version={}",
                                   kApplicationId, kSchemaVersion)
                           .c_str());
  write_meta(*connection_, "robot_id", robot_id);
  write_meta(*connection_, "seed", std::to_string(seed));
  write_meta(*connection_, "trajectory_version", "0");
  write_meta(*connection_, "global_map_version", "0");
  transaction.commit();
}

void MapDatabase::read_hashes(const char* table, BlobHashes& hashes) {
  SqliteStatement row(*connection_, fmt::format("SELECT id, blob_hash FROM {}", table));
  while (row.step()) {
    hashes[static_cast<std::uint32_t>(row.integer(0))] = as_unsigned(row.integer(1));
  }
}

void MapDatabase::read_state() {
  // Finds a file that was cut short now instead of at some later read.
  SqliteStatement check(*connection_, "PRAGMA quick_check(1)");
  const std::string verdict = check.step() ? check.text(0) : "no answer";
  if (verdict != "ok") {
    throw std::runtime_error(fmt::format("{}: cut short or damaged ({})", name_, verdict));
  }
  robot_id_ = read_meta(*connection_, "robot_id");
  seed_ = read_meta_number(*connection_, "seed");
  trajectory_version_ = read_meta_number(*connection_, "trajectory_version");
  SqliteStatement count(*connection_, "SELECT count(*) FROM local_map");
  count.step();
  local_map_count_ = static_cast<std::uint32_t>(count.integer(0));
  read_hashes("stop_pose", stop_hashes_);
  read_hashes("loop_closure", closure_hashes_);
  read_hashes("map_node", node_hashes_);
  read_hashes("map_branch", branch_hashes_);
}

void MapDatabase::put_local_map(const topomap::LocalMap& map) {
  if (map.robot_id != robot_id_ || map.id > local_map_count_) {
    throw std::invalid_argument(
        fmt::format("{}: local map {} of robot '{}', expected at most {} of robot '{}'", name_,
                    map.id, map.robot_id, local_map_count_, robot_id_));
  }
  const std::string blob = to_blob<proto::LocalMap>(map);
  const std::int64_t blob_hash = as_signed(support::fnv1a(blob));
  if (map.id < local_map_count_) {
    SqliteStatement stored(*connection_, "SELECT blob_hash FROM local_map WHERE id = ?");
    if (stored.bind(1, map.id).step() && stored.integer(0) == blob_hash) return;
    throw std::invalid_argument(
        fmt::format("{}: already holds another local map {}", name_, map.id));
  }
  SqliteStatement(*connection_,
                  "INSERT INTO local_map(id, stamp_ns, content_hash, blob_hash, blob) "
                  "VALUES(?, ?, ?, ?, ?)")
      .bind(1, map.id)
      .bind(2, map.stamp_ns)
      .bind(3, as_signed(topomap::content_hash(map)))
      .bind(4, blob_hash)
      .bind_blob(5, blob)
      .run();
  ++local_map_count_;
}

void MapDatabase::put_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                                 std::span<const topomap::LoopClosure> closures) {
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
  SqliteTransaction transaction(*connection_, SqliteTransaction::Kind::kWrite);
  TableWriter stop_writer(*connection_, "stop_pose", "", "");
  for (const topomap::StopPose& stop : changed) {
    stop_writer.put(stop_hashes, stop.local_map_id, to_blob<proto::StopPose>(stop));
  }
  // The place in the list is the id, so that reading gives back the caller's order.
  TableWriter closure_writer(*connection_, "loop_closure", ", earlier_id, later_id", ", ?, ?");
  for (std::size_t i = 0; i < closures.size(); ++i) {
    closure_writer.put(closure_hashes, static_cast<std::uint32_t>(i),
                       to_blob<proto::LoopClosure>(closures[i]),
                       {closures[i].earlier_id, closures[i].later_id});
  }
  closure_writer.remove_others(closure_hashes,
                               [&](std::uint32_t id) { return id < closures.size(); });
  write_meta(*connection_, "trajectory_version", std::to_string(version));
  transaction.commit();
  trajectory_version_ = version;
  stop_hashes_ = std::move(stop_hashes);
  closure_hashes_ = std::move(closure_hashes);
}

void MapDatabase::put_global_map(const topomap::GlobalMap& map) {
  try {
    check_global_map(map);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(fmt::format("{}: global map: {}", name_, error.what()));
  }
  BlobHashes node_hashes = node_hashes_;
  BlobHashes branch_hashes = branch_hashes_;
  SqliteTransaction transaction(*connection_, SqliteTransaction::Kind::kWrite);
  TableWriter node_writer(*connection_, "map_node", "", "");
  std::map<std::uint32_t, bool> kept;
  for (const topomap::MapNode& node : map.nodes) {
    node_writer.put(node_hashes, node.id, to_blob<proto::MapNode>(node));
    kept[node.id] = true;
  }
  node_writer.remove_others(node_hashes, [&](std::uint32_t id) { return kept.contains(id); });
  TableWriter branch_writer(*connection_, "map_branch", ", node_a, node_b", ", ?, ?");
  kept.clear();
  for (const topomap::MapBranch& branch : map.branches) {
    branch_writer.put(branch_hashes, branch.id, to_blob<proto::MapBranch>(branch),
                      {branch.node_a, branch.node_b});
    kept[branch.id] = true;
  }
  branch_writer.remove_others(branch_hashes, [&](std::uint32_t id) { return kept.contains(id); });
  write_meta(*connection_, "global_map_version", std::to_string(map.version));
  transaction.commit();
  node_hashes_ = std::move(node_hashes);
  branch_hashes_ = std::move(branch_hashes);
}

void MapDatabase::put_drawing(const MapDrawing& drawing) {
  try {
    check(drawing);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(fmt::format("{}: {}", name_, error.what()));
  }
  const std::string blob = to_blob<proto::Drawing>(drawing);
  SqliteTransaction transaction(*connection_, SqliteTransaction::Kind::kWrite);
  connection_->execute(kDrawingSchema);
  BlobHashes none_stored;
  TableWriter(*connection_, "drawing", "", "").put(none_stored, 0, blob);
  transaction.commit();
}

MapDocument MapDatabase::load() const {
  const SqliteTransaction one_state(*connection_, SqliteTransaction::Kind::kRead);
  MapDocument document;
  document.robot_id = robot_id_;
  document.seed = seed_;
  read_table<proto::LocalMap>(*connection_, "local_map", document.local_maps);
  document.trajectory.version = read_meta_number(*connection_, "trajectory_version");
  read_table<proto::StopPose>(*connection_, "stop_pose", document.trajectory.stops);
  read_table<proto::LoopClosure>(*connection_, "loop_closure", document.loop_closures);
  document.global_map.version = read_meta_number(*connection_, "global_map_version");
  read_table<proto::MapNode>(*connection_, "map_node", document.global_map.nodes);
  read_table<proto::MapBranch>(*connection_, "map_branch", document.global_map.branches);
  if (has_table(*connection_, "drawing")) {
    std::vector<MapDrawing> drawings;
    read_table<proto::Drawing>(*connection_, "drawing", drawings);
    if (!drawings.empty()) document.drawing = std::move(drawings.front());
  }
  try {
    check_document(document);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: damaged ({})", name_, error.what()));
  }
  return document;
}

}  // namespace topogeo::storage
