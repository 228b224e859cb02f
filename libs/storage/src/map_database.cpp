#include "topogeo/storage/map_database.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"
#include "map_file_writer.hpp"
#include "map_rows.hpp"
#include "map_schema.hpp"
#include "meta_table.hpp"
#include "sqlite_rows.hpp"
#include "stop_tables.hpp"
#include "table_writer.hpp"

namespace topogeo::storage {
namespace {

template <typename Check>
void require_valid(const std::string& file, const char* what, const Check& check) {
  try {
    check();
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(fmt::format("{}: {}{}", file, what, error.what()));
  }
}

}  // namespace

MapDatabase::MapDatabase(MapDatabase&&) noexcept = default;
MapDatabase& MapDatabase::operator=(MapDatabase&&) noexcept = default;
MapDatabase::~MapDatabase() = default;

MapDatabase::MapDatabase(const std::filesystem::path& path,
                         std::unique_ptr<SQLite::Database> database)
    : name_(path.string()),
      database_(std::move(database)),
      stops_(std::make_unique<StopTables>(*database_, name_)) {}

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
  database_->exec("PRAGMA foreign_keys=OFF");  // which changes nothing inside of a transaction
  SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
  // Another program may have done it meanwhile.
  if (stored_version(*database_) != kSchemaVersion) {
    MapDocument document = take_version_1(*database_);
    require_valid(name_, "damaged: ", [&] { check_document(document); });
    create_tables(*database_, document.robot_id, document.seed);
    robot_id_ = document.robot_id;
    write_document(identified(std::move(document)));
    transaction.commit();
  }
  database_->exec("PRAGMA foreign_keys=ON");
}

void MapDatabase::read_hashes(const char* table, BlobHashes& hashes) {
  hashes.clear();
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
  read_tables();
}

void MapDatabase::read_tables() {
  tables_are_known_ = false;
  map_id_ = read_meta_number(*database_, "map_id");
  trajectory_version_ = read_meta_number(*database_, "trajectory_version");
  stops_->read();
  read_hashes("stop_pose", hashes_.poses);
  read_hashes("loop_closure", hashes_.closures);
  read_hashes("edge", hashes_.edges);
  read_hashes("map_node", hashes_.nodes);
  read_hashes("map_branch", hashes_.branches);
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
    } catch (const std::exception&) {  // the error that counts is the first one
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
    if (map.robot_id == robot_id_ && map.stop.session != 0) continue;
    throw std::invalid_argument(
        fmt::format("{}: stop {} of session {:016x} of robot '{}', expected a session of '{}'",
                    name_, map.stop.number, map.stop.session, map.robot_id, robot_id_));
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

void MapDatabase::put_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                                 std::span<const topomap::LoopClosure> closures,
                                 std::span<const JoinedStop> joined) {
  change([&] {
    stops_->join(joined);
    write_trajectory(version, changed, closures);
  });
}

void MapDatabase::write_trajectory(std::uint64_t version,
                                   std::span<const topomap::StopPose> changed,
                                   std::span<const topomap::LoopClosure> closures) {
  if (version < trajectory_version_) {
    throw std::invalid_argument(
        fmt::format("{}: trajectory version {} after {}", name_, version, trajectory_version_));
  }
  const std::uint32_t count = stops_->joined();
  for (const topomap::StopPose& stop : changed) {
    if (stop.local_map_id < count) continue;
    throw std::invalid_argument(
        fmt::format("{}: stop {} has no local map yet", name_, stop.local_map_id));
  }
  for (const topomap::LoopClosure& c : closures) {
    if (c.earlier_id < c.later_id && c.later_id < count) continue;
    throw std::invalid_argument(fmt::format("{}: loop closure from {} to {}: expected ids below {}",
                                            name_, c.earlier_id, c.later_id, count));
  }
  TableWriter pose_writer(*database_, "stop_pose", ", version", ", ?");
  for (const topomap::StopPose& stop : changed) {
    pose_writer.put(hashes_.poses, stop.local_map_id, to_blob<proto::StopPose>(stop),
                    {as_signed(version)});
  }
  // The place in the list is the id, so that reading gives back the caller's order.
  TableWriter closure_writer(*database_, "loop_closure", ", earlier_id, later_id", ", ?, ?");
  for (std::size_t i = 0; i < closures.size(); ++i) {
    closure_writer.put(hashes_.closures, static_cast<std::uint32_t>(i),
                       to_blob<proto::LoopClosure>(closures[i]),
                       {closures[i].earlier_id, closures[i].later_id});
  }
  closure_writer.remove_others(hashes_.closures,
                               [&](std::uint32_t id) { return id < closures.size(); });
  write_meta(*database_, "trajectory_version", std::to_string(version));
  trajectory_version_ = version;
}

void MapDatabase::put_edges(const std::vector<MapEdge>& edges) {
  change([&] { write_edges(edges); });
}

void MapDatabase::write_edges(const std::vector<MapEdge>& edges) {
  require_valid(name_, "", [&] { check_edges(edges, stops_->joined()); });
  TableWriter writer(*database_, "edge", ", earlier_id, later_id", ", ?, ?");
  for (std::size_t i = 0; i < edges.size(); ++i) {
    writer.put(hashes_.edges, static_cast<std::uint32_t>(i), to_blob<proto::MapEdge>(edges[i]),
               {edges[i].earlier_id, edges[i].later_id});
  }
  writer.remove_others(hashes_.edges, [&](std::uint32_t id) { return id < edges.size(); });
}

void MapDatabase::put_global_map(const topomap::GlobalMap& map) {
  change([&] { write_global_map(map); });
}

void MapDatabase::write_global_map(const topomap::GlobalMap& map) {
  require_valid(name_, "global map: ", [&] { check_global_map(map); });
  TableWriter node_writer(*database_, "map_node");
  std::vector<std::uint32_t> kept;  // ascending, as the check has found
  const auto is_kept = [&](std::uint32_t id) { return std::ranges::binary_search(kept, id); };
  for (const topomap::MapNode& node : map.nodes) {
    node_writer.put(hashes_.nodes, node.id, to_blob<proto::MapNode>(node));
    kept.push_back(node.id);
  }
  node_writer.remove_others(hashes_.nodes, is_kept);
  TableWriter branch_writer(*database_, "map_branch", ", node_a, node_b", ", ?, ?");
  kept.clear();
  for (const topomap::MapBranch& branch : map.branches) {
    branch_writer.put(hashes_.branches, branch.id, to_blob<proto::MapBranch>(branch),
                      {branch.node_a, branch.node_b});
    kept.push_back(branch.id);
  }
  branch_writer.remove_others(hashes_.branches, is_kept);
  write_meta(*database_, "global_map_version", std::to_string(map.version));
}

void MapDatabase::put_drawing(const MapDrawing& drawing) {
  change([&] { write_drawing(drawing); });
}

void MapDatabase::write_drawing(const MapDrawing& drawing) {
  require_valid(name_, "", [&] { check(drawing); });
  for (const char* table : {"place", "zone", "drawn_grid"}) {
    database_->exec(fmt::format("DELETE FROM {}", table));
  }
  BlobHashes none_stored;
  TableWriter place_writer(*database_, "place", ", name", ", ?");
  for (const planning::Place& place : drawing.places) {
    place_writer.put(none_stored, static_cast<std::uint32_t>(none_stored.size()),
                     to_blob<proto::Place>(place), {}, {place.name});
  }
  none_stored.clear();
  TableWriter zone_writer(*database_, "zone", ", name, kind", ", ?, ?");
  for (const planning::DrawnZone& zone : drawing.zones) {
    zone_writer.put(none_stored, static_cast<std::uint32_t>(none_stored.size()),
                    to_blob<proto::DrawnZone>(zone), {},
                    {zone.name, planning::to_string(zone.kind)});
  }
  none_stored.clear();
  if (drawing.grid) {
    TableWriter(*database_, "drawn_grid")
        .put(none_stored, 0, to_blob<proto::DrawnGrid>(*drawing.grid));
  }
}

void MapDatabase::put_document(const MapDocument& document) {
  require_valid(name_, "map to be stored: ", [&] { check_document(document); });
  change([&] { write_document(identified(document)); });
}

void MapDatabase::write_document(const MapDocument& document) {
  if (document.robot_id != robot_id_ || !stops_->sessions().empty()) {
    throw std::invalid_argument(
        fmt::format("{}: expected no stops and the map of robot '{}', got that of robot '{}'",
                    name_, robot_id_, document.robot_id));
  }
  std::vector<JoinedStop> joined;
  for (const topomap::LocalMap& map : document.local_maps) {
    static_cast<void>(stops_->put({&map, 1}, true));
    joined.push_back({map.stop, false});
  }
  stops_->join(joined);
  if (document.map_id != 0) write_map_id(document.map_id);
  write_trajectory(document.trajectory.version, document.trajectory.stops, document.loop_closures);
  write_edges(document.edges);
  write_global_map(document.global_map);
  write_drawing(document.drawing);
}

MapDocument MapDatabase::load() const try {
  const SQLite::Transaction one_state(*database_, SQLite::TransactionBehavior::DEFERRED);
  MapDocument document;
  stops_->for_each([&](topomap::LocalMap map) { document.local_maps.push_back(std::move(map)); });
  load_rest(document);
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

void MapDatabase::load_rest(MapDocument& document) const {
  document.robot_id = robot_id_;
  document.seed = seed_;
  document.map_id = read_meta_number(*database_, "map_id");
  document.trajectory.version = read_meta_number(*database_, "trajectory_version");
  read_table<proto::StopPose>(*database_, name_, "stop_pose", document.trajectory.stops);
  read_table<proto::LoopClosure>(*database_, name_, "loop_closure", document.loop_closures);
  read_table<proto::MapEdge>(*database_, name_, "edge", document.edges);
  document.global_map.version = read_meta_number(*database_, "global_map_version");
  read_table<proto::MapNode>(*database_, name_, "map_node", document.global_map.nodes);
  read_table<proto::MapBranch>(*database_, name_, "map_branch", document.global_map.branches);
  read_table<proto::Place>(*database_, name_, "place", document.drawing.places);
  read_table<proto::DrawnZone>(*database_, name_, "zone", document.drawing.zones);
  std::vector<planning::OccupancyGrid> grids;
  read_table<proto::DrawnGrid>(*database_, name_, "drawn_grid", grids);
  if (!grids.empty()) document.drawing.grid = std::move(grids.front());
}

void MapDatabase::write_map_file(const std::function<void(std::string_view)>& sink) const try {
  const SQLite::Transaction one_state(*database_, SQLite::TransactionBehavior::DEFERRED);
  MapFileWriter writer(sink, robot_id_, seed_);
  stops_->for_each([&](const topomap::LocalMap& map) { writer.add(map); });
  MapDocument rest;
  load_rest(rest);
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

}  // namespace topogeo::storage
