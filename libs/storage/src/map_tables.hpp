// Tables derived from the stops of a map: poses, loop closures, edges, the global map, and its
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

/// Caches the hash of each stored blob, to write only changes. If the transaction around a change
/// fails, call read() to restore the cache. All changes are parts of a transaction.
class MapTables {
 public:
  MapTables(SQLite::Database& database, std::string file);

  void read();

  /// Like MapDatabase::put_trajectory and so on, in a map with `stops` stops.
  void write_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                        std::span<const topomap::LoopClosure> closures, std::uint32_t stops);
  /// Deletes poses, closures, edges and verdicts; call before the stops are renumbered.
  void forget_stops();
  void write_numbered_since(std::uint64_t version);
  void write_edges(const std::vector<MapEdge>& edges, std::uint32_t stops);
  void write_global_map(const topomap::GlobalMap& map);
  void write_drawing(const MapDrawing& drawing);
  void write_refused_merges(std::span<const RefusedMerge> refused);
  void write_rooms(const planning::RoomMemory& rooms);
  void write_loop_verdicts(const std::vector<LoopVerdict>& verdicts, std::uint32_t stops);

  [[nodiscard]] std::vector<LoopVerdict> loop_verdicts() const;
  /// Loads all of a map except its local maps, without a check of the whole.
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
  BlobHashes verdict_hashes_;
};

}  // namespace topogeo::storage
