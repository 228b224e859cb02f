#include "map_tables.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <SQLiteCpp/Statement.h>

#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"
#include "map_rows.hpp"
#include "meta_table.hpp"
#include "sqlite_rows.hpp"

namespace topogeo::storage {

namespace {

// Made with the first verdict, so that older programs read the file.
constexpr const char* kVerdictTable = R"(
  CREATE TABLE IF NOT EXISTS loop_verdict(
    id INTEGER PRIMARY KEY, blob_hash INTEGER NOT NULL, blob BLOB NOT NULL);
)";

}  // namespace

MapTables::MapTables(SQLite::Database& database, std::string file)
    : database_(database), file_(std::move(file)) {}

void MapTables::read() {
  trajectory_version_ = read_meta_number(database_, "trajectory_version");
  numbered_since_ = read_meta_number_or(database_, "numbered_since", 0);
  read_hashes("stop_pose", pose_hashes_);
  read_hashes("loop_closure", closure_hashes_);
  read_hashes("edge", edge_hashes_);
  read_hashes("map_node", node_hashes_);
  read_hashes("map_branch", branch_hashes_);
  read_hashes("room", room_hashes_);
  read_hashes("room_place", room_place_hashes_);
  verdict_hashes_.clear();
  if (database_.tableExists("loop_verdict")) read_hashes("loop_verdict", verdict_hashes_);
}

void MapTables::write_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                                 std::span<const topomap::LoopClosure> closures,
                                 std::uint32_t stops) {
  if (version < trajectory_version_) {
    throw std::invalid_argument(
        fmt::format("{}: trajectory version {} after {}", file_, version, trajectory_version_));
  }
  for (const topomap::StopPose& stop : changed) {
    if (stop.local_map_id < stops) continue;
    throw std::invalid_argument(
        fmt::format("{}: stop {} has no local map yet", file_, stop.local_map_id));
  }
  for (const topomap::LoopClosure& c : closures) {
    if (c.earlier_id < c.later_id && c.later_id < stops) continue;
    throw std::invalid_argument(fmt::format("{}: loop closure from {} to {}: expected ids below {}",
                                            file_, c.earlier_id, c.later_id, stops));
  }
  TableWriter pose_writer(database_, "stop_pose", ", version", ", ?");
  for (const topomap::StopPose& stop : changed) {
    pose_writer.put(pose_hashes_, stop.local_map_id, to_blob<proto::StopPose>(stop),
                    {as_signed(version)});
  }
  // The index in the list is the id, so that reading restores the caller's order.
  TableWriter closure_writer(database_, "loop_closure", ", earlier_id, later_id", ", ?, ?");
  for (std::size_t i = 0; i < closures.size(); ++i) {
    closure_writer.put(closure_hashes_, static_cast<std::uint32_t>(i),
                       to_blob<proto::LoopClosure>(closures[i]),
                       {closures[i].earlier_id, closures[i].later_id});
  }
  closure_writer.remove_others(closure_hashes_,
                               [&](std::uint32_t id) { return id < closures.size(); });
  write_meta(database_, "trajectory_version", std::to_string(version));
  trajectory_version_ = version;
}

void MapTables::forget_stops() {
  for (const char* table : {"edge", "loop_closure", "stop_pose"}) {
    database_.exec(fmt::format("DELETE FROM {}", table));
  }
  if (database_.tableExists("loop_verdict")) database_.exec("DELETE FROM loop_verdict");
  verdict_hashes_.clear();
  edge_hashes_.clear();
  closure_hashes_.clear();
  pose_hashes_.clear();
}

void MapTables::write_numbered_since(std::uint64_t version) {
  if (version == numbered_since_) return;
  write_meta(database_, "numbered_since", std::to_string(version));
  numbered_since_ = version;
}

void MapTables::write_edges(const std::vector<MapEdge>& edges, std::uint32_t stops) {
  require_valid(file_, "", [&] { check_edges(edges, stops); });
  TableWriter writer(database_, "edge", ", earlier_id, later_id", ", ?, ?");
  for (std::size_t i = 0; i < edges.size(); ++i) {
    writer.put(edge_hashes_, static_cast<std::uint32_t>(i), to_blob<proto::MapEdge>(edges[i]),
               {edges[i].earlier_id, edges[i].later_id});
  }
  writer.remove_others(edge_hashes_, [&](std::uint32_t id) { return id < edges.size(); });
}

void MapTables::write_global_map(const topomap::GlobalMap& map) {
  require_valid(file_, "global map: ", [&] { check_global_map(map); });
  TableWriter node_writer(database_, "map_node");
  std::vector<std::uint32_t> kept;  // ascending, as checked before
  const auto is_kept = [&](std::uint32_t id) { return std::ranges::binary_search(kept, id); };
  for (const topomap::MapNode& node : map.nodes) {
    node_writer.put(node_hashes_, node.id, to_blob<proto::MapNode>(node));
    kept.push_back(node.id);
  }
  node_writer.remove_others(node_hashes_, is_kept);
  TableWriter branch_writer(database_, "map_branch", ", node_a, node_b", ", ?, ?");
  kept.clear();
  for (const topomap::MapBranch& branch : map.branches) {
    branch_writer.put(branch_hashes_, branch.id, to_blob<proto::MapBranch>(branch),
                      {branch.node_a, branch.node_b});
    kept.push_back(branch.id);
  }
  branch_writer.remove_others(branch_hashes_, is_kept);
  write_meta(database_, "global_map_version", std::to_string(map.version));
}

void MapTables::write_drawing(const MapDrawing& drawing) {
  require_valid(file_, "", [&] { check(drawing); });
  for (const char* table : {"place", "zone", "drawn_line", "drawn_grid"}) {
    database_.exec(fmt::format("DELETE FROM {}", table));
  }
  BlobHashes none_stored;
  TableWriter place_writer(database_, "place", ", name", ", ?");
  for (const planning::Place& place : drawing.places) {
    place_writer.put(none_stored, static_cast<std::uint32_t>(none_stored.size()),
                     to_blob<proto::Place>(place), {}, {place.name});
  }
  none_stored.clear();
  TableWriter zone_writer(database_, "zone", ", name, kind", ", ?, ?");
  for (const planning::DrawnZone& zone : drawing.zones) {
    zone_writer.put(none_stored, static_cast<std::uint32_t>(none_stored.size()),
                    to_blob<proto::DrawnZone>(zone), {},
                    {zone.name, planning::to_string(zone.kind)});
  }
  none_stored.clear();
  TableWriter line_writer(database_, "drawn_line", ", kind", ", ?");
  for (const planning::DrawnLine& line : drawing.lines) {
    line_writer.put(none_stored, static_cast<std::uint32_t>(none_stored.size()),
                    to_blob<proto::DrawnLine>(line), {}, {list_of(line.kind)});
  }
  none_stored.clear();
  if (drawing.grid) {
    TableWriter(database_, "drawn_grid")
        .put(none_stored, 0, to_blob<proto::DrawnGrid>(*drawing.grid));
  }
  write_meta(database_, "drawing_version", std::to_string(drawing.version));
}

void MapTables::write_rooms(const planning::RoomMemory& rooms) {
  require_valid(file_, "", [&] { check_rooms(rooms); });
  TableWriter room_writer(database_, "room", ", name", ", ?");
  for (const planning::RememberedRoom& room : rooms.rooms) {
    room_writer.put(room_hashes_, room.number, to_blob<proto::Room>(room), {}, {room.name});
  }
  room_writer.remove_others(room_hashes_, [&](std::uint32_t number) {
    return std::ranges::find(rooms.rooms, number, &planning::RememberedRoom::number) !=
           rooms.rooms.end();
  });
  TableWriter place_writer(database_, "room_place", ", name", ", ?");
  for (std::size_t i = 0; i < rooms.places.size(); ++i) {
    place_writer.put(room_place_hashes_, static_cast<std::uint32_t>(i),
                     to_blob<proto::PlaceInRoom>(rooms.places[i]), {},
                     {rooms.places[i].drawn.name});
  }
  place_writer.remove_others(room_place_hashes_,
                             [&](std::uint32_t id) { return id < rooms.places.size(); });
  write_meta(database_, "last_room", std::to_string(rooms.last));
}

void MapTables::write_loop_verdicts(const std::vector<LoopVerdict>& verdicts, std::uint32_t stops) {
  require_valid(file_, "", [&] { check_verdicts(verdicts, stops); });
  database_.exec(kVerdictTable);
  TableWriter writer(database_, "loop_verdict");
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    writer.put(verdict_hashes_, static_cast<std::uint32_t>(i),
               to_blob<proto::LoopVerdict>(verdicts[i]));
  }
  writer.remove_others(verdict_hashes_, [&](std::uint32_t id) { return id < verdicts.size(); });
}

std::vector<LoopVerdict> MapTables::loop_verdicts() const {
  std::vector<LoopVerdict> verdicts;
  if (database_.tableExists("loop_verdict")) {
    read_table<proto::LoopVerdict>(database_, file_, "loop_verdict", verdicts);
  }
  return verdicts;
}

void MapTables::load(MapDocument& document) const {
  document.robot_id = read_meta(database_, "robot_id");
  document.seed = read_meta_number(database_, "seed");
  document.map_id = read_meta_number(database_, "map_id");
  document.trajectory.version = read_meta_number(database_, "trajectory_version");
  document.trajectory.numbered_since = read_meta_number_or(database_, "numbered_since", 0);
  read_table<proto::StopPose>(database_, file_, "stop_pose", document.trajectory.stops);
  read_table<proto::LoopClosure>(database_, file_, "loop_closure", document.loop_closures);
  read_table<proto::MapEdge>(database_, file_, "edge", document.edges);
  document.global_map.version = read_meta_number(database_, "global_map_version");
  read_table<proto::MapNode>(database_, file_, "map_node", document.global_map.nodes);
  read_table<proto::MapBranch>(database_, file_, "map_branch", document.global_map.branches);
  read_table<proto::Place>(database_, file_, "place", document.drawing.places);
  read_table<proto::DrawnZone>(database_, file_, "zone", document.drawing.zones);
  read_table<proto::DrawnLine>(database_, file_, "drawn_line", document.drawing.lines);
  document.drawing.version = read_meta_number_or(database_, "drawing_version", 0);
  std::vector<planning::OccupancyGrid> grids;
  read_table<proto::DrawnGrid>(database_, file_, "drawn_grid", grids);
  if (!grids.empty()) document.drawing.grid = std::move(grids.front());
  document.refused_merges = refused_merges();
  read_table<proto::Room>(database_, file_, "room", document.rooms.rooms);
  read_table<proto::PlaceInRoom>(database_, file_, "room_place", document.rooms.places);
  document.rooms.last = static_cast<std::uint32_t>(read_meta_number_or(database_, "last_room", 0));
  document.loop_verdicts = loop_verdicts();
}

// Few and short: stored as one value, so that older programs can still read the file.
void MapTables::write_refused_merges(std::span<const RefusedMerge> refused) {
  std::string text;
  for (const RefusedMerge& merge : refused) {
    text += fmt::format("{:016x} {} {:016x} {}\n", merge.stop.session, merge.stop.number,
                        merge.other.session, merge.other.number);
  }
  write_meta(database_, "refused_merges", text);
}

std::vector<RefusedMerge> MapTables::refused_merges() const {
  std::istringstream text(read_meta_or_empty(database_, "refused_merges"));
  std::vector<RefusedMerge> out;
  RefusedMerge merge;
  while (text >> std::hex >> merge.stop.session >> std::dec >> merge.stop.number >> std::hex >>
         merge.other.session >> std::dec >> merge.other.number) {
    out.push_back(merge);
  }
  if (!text.eof()) {
    throw std::runtime_error(file_ + ": damaged (refused_merges is no list of pairs of stops)");
  }
  return out;
}

void MapTables::read_hashes(const char* table, BlobHashes& hashes) {
  hashes.clear();
  SQLite::Statement row(database_, fmt::format("SELECT id, blob_hash FROM {}", table));
  while (row.executeStep()) {
    hashes[static_cast<std::uint32_t>(integer_at(row, 0))] = as_unsigned(integer_at(row, 1));
  }
}

}  // namespace topogeo::storage
