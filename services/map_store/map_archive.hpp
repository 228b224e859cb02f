// Keeps the file of a map store in step with its input: local maps as soon as they arrive, numbers
// and poses as soon as the trajectory has them.
//
// Data that cannot be stored, because the disk is full or another program holds the file, stays in
// memory and is stored later. A file that was removed is written again.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "topogeo/storage/map_database.hpp"

namespace topogeo::map_store {

class MapArchive {
 public:
  /// Largest number of local maps in one transaction, which takes about 30 ms.
  static constexpr std::size_t kBatch = 64;
  /// Largest number of unstored local maps in memory, about 60 MB: their senders keep the
  /// unacknowledged ones.
  static constexpr std::size_t kMostQueued = 4096;
  /// Largest number of local maps kept that no trajectory has named, the newest ones.
  static constexpr std::size_t kMostWaiting = 4096;

  /// `path` is the file of `database`.
  MapArchive(storage::MapDatabase database, std::filesystem::path path);

  /// Adds an arrived local map as it was sent. The next flush() stores it, if it is new.
  void add(const topomap::LocalMap& map);
  [[nodiscard]] bool has_batch() const { return queue_.size() >= kBatch; }
  [[nodiscard]] std::size_t queued() const { return queue_.size(); }

  /// Stores the local maps that have arrived. Returns those that differ from the stored ones of the
  /// same number. Throws std::runtime_error naming file and cause; unstored maps stay queued.
  std::vector<topomap::StopId> flush();

  /// Stores the stops of the map, their poses and the closures. `local_maps` begin with those that
  /// the map had before, unless the trajectory has renumbered them: then those that it does not
  /// name leave the map. Throws like flush(), and std::invalid_argument when a local map is not
  /// stored.
  void put(std::span<const topomap::LocalMap> local_maps, const topomap::Trajectory& trajectory,
           std::span<const topomap::LoopClosure> closures);
  void put(const std::vector<storage::MapEdge>& edges);
  void put(const topomap::GlobalMap& map);
  void put(const storage::MapDrawing& drawing);
  void put(const std::vector<storage::RefusedMerge>& refused);
  void put(const planning::RoomMemory& rooms);
  void put(const std::vector<storage::LoopVerdict>& verdicts);

  [[nodiscard]] const storage::MapDatabase& database() const { return database_; }

 private:
  void remember(const topomap::Trajectory& trajectory,
                std::span<const topomap::LoopClosure> closures);
  /// Writes the file again if it was removed. Throws when another file has taken its place.
  void check_file();

  storage::MapDatabase database_;
  std::filesystem::path path_;
  std::uint64_t file_ = 0;  // inode number of the open file
  std::vector<topomap::LocalMap> queue_;
  std::set<topomap::StopId> queued_;
  // State of the last trajectory put. Its version does not identify its poses: while segments are
  // under way, it has older poses beside newer ones.
  std::uint64_t version_ = 0;
  std::uint64_t poses_ = 0;     // their hash
  std::uint64_t closures_ = 0;  // their hash
};

}  // namespace topogeo::map_store
