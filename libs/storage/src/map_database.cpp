#include "topogeo/storage/map_database.hpp"

#include <stdexcept>
#include <system_error>
#include <utility>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include "topogeo/sqlite_guard/sqlite_guard.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"
#include "map_file_writer.hpp"
#include "map_schema.hpp"
#include "map_tables.hpp"
#include "meta_table.hpp"
#include "sqlite_rows.hpp"
#include "stop_tables.hpp"

namespace topogeo::storage {
MapDatabase::MapDatabase(MapDatabase&&) noexcept = default;
MapDatabase& MapDatabase::operator=(MapDatabase&&) noexcept = default;
MapDatabase::~MapDatabase() = default;

MapDatabase::MapDatabase(const std::filesystem::path& path,
                         std::unique_ptr<SQLite::Database> database)
    : name_(path.string()),
      database_(std::move(database)),
      stops_(std::make_unique<StopTables>(*database_, name_)),
      tables_(std::make_unique<MapTables>(*database_, name_)) {}

MapDatabase MapDatabase::open_or_create(const std::filesystem::path& path,
                                        const std::string& robot_id, std::uint64_t seed) try {
  MapDatabase database(path, open_map_database(path, Access::kCreate));
  if (!has_content(*database.database_)) database.create(robot_id, seed);
  database.migrate();
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
  MapDatabase database(path, open_map_database(path, Access::kExisting));
  database.migrate();
  database.read_state();
  return database;
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

MapDatabase MapDatabase::open_read_only(const std::filesystem::path& path) try {
  auto file = open_map_database(path, Access::kReadOnly);
  if (stored_version(*file) != kSchemaVersion) file = copy_in_memory(*file);
  MapDatabase database(path, std::move(file));
  database.migrate();
  database.read_state();
  return database;
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

void MapDatabase::check_replaceable(const std::filesystem::path& path) try {
  static_cast<void>(open_map_database(path, Access::kCreate));
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

void MapDatabase::set_patience(std::chrono::milliseconds patience) {
  database_->setBusyTimeout(static_cast<int>(patience.count()));
}

void MapDatabase::create(const std::string& robot_id, std::uint64_t seed) {
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  create_tables(*database_, robot_id, seed);
  transaction.commit();
}

void MapDatabase::migrate() {
  if (stored_version(*database_) == kSchemaVersion) return;
  database_->exec("PRAGMA foreign_keys=OFF");  // has no effect inside a transaction
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  // Another program may have upgraded it meanwhile.
  const std::int64_t version = stored_version(*database_);
  if (version == 2 || version == 3) {
    if (version == 2) make_version_3_of_2(*database_);
    make_version_4_of_3(*database_);
    transaction.commit();
  } else if (version != kSchemaVersion) {
    MapDocument document = take_version_1(*database_);
    require_valid(name_, "damaged: ", [&] { check_document(document); });
    create_tables(*database_, document.robot_id, document.seed);
    robot_id_ = document.robot_id;
    write_document(identified(std::move(document)));
    transaction.commit();
  }
  database_->exec("PRAGMA foreign_keys=ON");
}

void MapDatabase::read_state() {
  const sqlite_guard::WorkLimit limit(database_->getHandle(), sqlite_guard::bytes_of(name_));
  // Detects a truncated file now instead of at some later read.
  SQLite::Statement check(*database_, "PRAGMA quick_check(1)");
  const std::string verdict = check.executeStep() ? text_at(check, 0) : "no answer";
  if (verdict != "ok") {
    throw std::runtime_error(fmt::format("{}: cut short or damaged ({})", name_, verdict));
  }
  robot_id_ = read_meta(*database_, "robot_id");
  seed_ = read_meta_number(*database_, "seed");
  read_tables();
}

void MapDatabase::read_tables() {
  tables_are_known_ = false;
  map_id_ = read_meta_number(*database_, "map_id");
  stops_->read();
  tables_->read();
  tables_are_known_ = true;
}

template <typename Work>
void MapDatabase::change(const Work& work) try {
  try {
    SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
    if (!tables_are_known_) read_tables();
    tables_are_known_ = false;
    work();
    transaction.commit();
    tables_are_known_ = true;
  } catch (...) {
    try {
      if (!tables_are_known_) read_tables();
    } catch (const std::exception&) {  // the first error counts
      stops_->forget();
    }
    throw;
  }
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

std::vector<topomap::StopId> MapDatabase::put_stops(std::span<const topomap::LocalMap> stops) {
  std::vector<topomap::StopId> different;
  change([&] { different = write_stops(stops); });
  return different;
}

std::vector<topomap::StopId> MapDatabase::write_stops(std::span<const topomap::LocalMap> stops) {
  for (const topomap::LocalMap& map : stops) {
    if (!map.robot_id.empty() && map.stop.session != 0) continue;
    throw std::invalid_argument(
        fmt::format("{}: stop {} of session {:016x} of robot '{}', expected a session and a robot",
                    name_, map.stop.number, map.stop.session, map.robot_id));
  }
  std::vector<topomap::StopId> different = stops_->put(stops, false);
  if (map_id_ == 0 && !stops.empty()) write_map_id(map_id_of(stops.front().stop.session));
  return different;
}

void MapDatabase::write_map_id(std::uint64_t map_id) {
  write_meta(*database_, "map_id", std::to_string(map_id));
  map_id_ = map_id;
}

void MapDatabase::join(std::span<const JoinedStop> stops) {
  change([&] { stops_->join(stops); });
}

std::size_t MapDatabase::drop_waiting(std::size_t most) {
  std::size_t dropped = 0;
  change([&] { dropped = stops_->drop_waiting(most); });
  return dropped;
}

void MapDatabase::drop_session(std::uint64_t session) {
  change([&] { stops_->drop_session(session); });
}

void MapDatabase::compact() try {
  database_->exec("VACUUM; PRAGMA wal_checkpoint(TRUNCATE)");
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

void MapDatabase::put_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                                 std::span<const topomap::LoopClosure> closures,
                                 std::span<const JoinedStop> joined) {
  change([&] {
    stops_->join(joined);
    tables_->write_trajectory(version, changed, closures, stops_->joined());
  });
}

void MapDatabase::renew(const topomap::Trajectory& trajectory,
                        std::span<const topomap::LoopClosure> closures,
                        std::span<const JoinedStop> stops) {
  change([&] {
    tables_->forget_stops();
    stops_->renew(stops);
    tables_->write_trajectory(trajectory.version, trajectory.stops, closures, stops_->joined());
    tables_->write_numbered_since(trajectory.numbered_since);
  });
}

void MapDatabase::put_edges(const std::vector<MapEdge>& edges) {
  change([&] { tables_->write_edges(edges, stops_->joined()); });
}

void MapDatabase::put_global_map(const topomap::GlobalMap& map) {
  change([&] { tables_->write_global_map(map); });
}

void MapDatabase::put_drawing(const MapDrawing& drawing) {
  change([&] { tables_->write_drawing(drawing); });
}

void MapDatabase::put_refused_merges(std::span<const RefusedMerge> refused) {
  change([&] { tables_->write_refused_merges(refused); });
}

void MapDatabase::put_rooms(const planning::RoomMemory& rooms) {
  change([&] { tables_->write_rooms(rooms); });
}

void MapDatabase::put_loop_verdicts(const std::vector<LoopVerdict>& verdicts) {
  change([&] { tables_->write_loop_verdicts(verdicts, stops_->joined()); });
}

void MapDatabase::put_document(const MapDocument& document) {
  require_valid(name_, "map to be stored: ", [&] { check_document(document); });
  change([&] { write_document(identified(document)); });
}

void MapDatabase::write_document(const MapDocument& document) {
  if (document.robot_id != robot_id_ || !stops_->sessions().empty()) {
    throw std::invalid_argument(fmt::format(
        "{}: expected an empty database and a map of robot '{}', got a map of robot '{}'", name_,
        robot_id_, document.robot_id));
  }
  std::vector<JoinedStop> joined;
  for (const topomap::LocalMap& map : document.local_maps) {
    static_cast<void>(stops_->put({&map, 1}, true));
    joined.push_back({map.stop, false});
  }
  stops_->join(joined);
  if (document.map_id != 0) write_map_id(document.map_id);
  tables_->write_trajectory(document.trajectory.version, document.trajectory.stops,
                            document.loop_closures, stops_->joined());
  tables_->write_numbered_since(document.trajectory.numbered_since);
  tables_->write_edges(document.edges, stops_->joined());
  tables_->write_global_map(document.global_map);
  tables_->write_drawing(document.drawing);
  if (!document.refused_merges.empty()) tables_->write_refused_merges(document.refused_merges);
  if (!document.rooms.empty()) tables_->write_rooms(document.rooms);
  if (!document.loop_verdicts.empty()) {
    tables_->write_loop_verdicts(document.loop_verdicts, stops_->joined());
  }
}

MapDocument MapDatabase::load() const try {
  const SQLite::Transaction one_state(*database_, SQLite::TransactionBehavior::DEFERRED);
  MapDocument document;
  stops_->for_each([&](topomap::LocalMap map) { document.local_maps.push_back(std::move(map)); });
  tables_->load(document);
  try {
    check_document(document);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: damaged ({})", name_, error.what()));
  }
  name_stops(document);
  return document;
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

void MapDatabase::write_map_file(const std::function<void(std::string_view)>& sink) const try {
  const SQLite::Transaction one_state(*database_, SQLite::TransactionBehavior::DEFERRED);
  MapFileWriter writer(sink, robot_id_, seed_);
  stops_->for_each([&](const topomap::LocalMap& map) { writer.add(map); });
  MapDocument rest;
  tables_->load(rest);
  writer.finish(rest);
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

std::size_t MapDatabase::write_local_maps(std::uint64_t session, std::uint32_t first,
                                          const std::function<void(std::string_view)>& sink) const
    try {
  std::size_t count = 0;
  stops_->for_each_of(session, first, [&](const topomap::LocalMap& map) {
    sink(local_maps_bytes({&map, 1}));
    ++count;
  });
  return count;
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

std::optional<topomap::LocalMap> MapDatabase::stop(const topomap::StopId& stop) const try {
  return stops_->stop(stop);
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

std::vector<LoopVerdict> MapDatabase::loop_verdicts() const try {
  return tables_->loop_verdicts();
} catch (const SQLite::Exception& error) {
  throw_named(name_, error);
}

std::size_t MapDatabase::waiting_count() const {
  return stops_->waiting_count();
}

bool MapDatabase::knows(const topomap::StopId& stop) const {
  return stops_->knows(stop);
}

std::vector<topomap::StopId> MapDatabase::waiting_stops() const {
  return stops_->waiting();
}

std::vector<SessionState> MapDatabase::sessions() const {
  return stops_->sessions();
}

std::uint64_t MapDatabase::trajectory_version() const {
  return tables_->trajectory_version();
}

std::uint64_t MapDatabase::numbered_since() const {
  return tables_->numbered_since();
}

std::uint32_t MapDatabase::local_map_count() const {
  return stops_->joined();
}

void MapDatabase::copy_to(const std::filesystem::path& path) const try {
  SQLite::Statement copy(*database_, "VACUUM INTO ?");
  copy.bind(1, path.string());
  copy.exec();
} catch (const SQLite::Exception& error) {
  throw_named(path.string(), error);
}

std::uintmax_t database_bytes(const std::filesystem::path& path) {
  return sqlite_guard::bytes_of(path);
}

}  // namespace topogeo::storage
