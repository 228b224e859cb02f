// What was made of the stops of a map: poses, loop closures, edges, the global map, and its
// drawing.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <SQLiteCpp/Database.h>

#include "topogeo/storage/map_document.hpp"

#include "table_writer.hpp"

namespace topogeo::storage {

/// Remembers the hash of each stored blob, to write only what has changed. When the transaction
/// around a change fails call read() to know them again. All changes are parts of a transaction.
class MapTables {
 public:
  MapTables(SQLite::Database& database, std::string file);

  void read();

  /// As MapDatabase::put_trajectory and so on, in a map of so many stops.
  void write_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                        std::span<const topomap::LoopClosure> closures, std::uint32_t stops);
  /// Poses, closures and edges; before the stops get other numbers.
  void forget_stops();
  void write_numbered_since(std::uint64_t version);
  void write_edges(const std::vector<MapEdge>& edges, std::uint32_t stops);
  void write_global_map(const topomap::GlobalMap& map);
  void write_drawing(const MapDrawing& drawing);
  void write_refused_merges(std::span<const RefusedMerge> refused);
  void write_rooms(const planning::RoomMemory& rooms);

  /// All of a map but its local maps, not checked as a whole.
  void load(MapDocument& document) const;

  [[nodiscard]] std::uint64_t trajectory_version() const { return trajectory_version_; }
  [[nodiscard]] std::uint64_t numbered_since() const { return numbered_since_; }

 private:
  [[nodiscard]] std::vector<RefusedMerge> refused_merges() const;
  void read_hashes(const char* table, BlobHashes& hashes);

  SQLite::Database& database_;
  std::string file_;
  std::uint64_t trajectory_version_ = 0;
  std::uint64_t numbered_since_ = 0;
  BlobHashes pose_hashes_;
  BlobHashes closure_hashes_;
  BlobHashes edge_hashes_;
  BlobHashes node_hashes_;
  BlobHashes branch_hashes_;
  BlobHashes room_hashes_;
  BlobHashes room_place_hashes_;
};

}  // namespace topogeo::storage
