// Keeps the file of a map store in step with what comes: local maps as soon as they are there,
// numbers and poses as soon as the trajectory has them.
//
// What cannot be stored, because the disk is full or another program holds the file, stays in
// memory and is stored when it can be. A file that somebody has removed is written again.
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
  /// So many local maps, and not more, are stored in one transaction: it takes about 30 ms.
  static constexpr std::size_t kBatch = 64;
  /// At most so many local maps that cannot be stored are kept, about 60 MB: their senders keep
  /// what is not acknowledged.
  static constexpr std::size_t kMostQueued = 4096;
  /// Local maps that no trajectory has named are kept, the newest ones.
  static constexpr std::size_t kMostWaiting = 4096;

  /// `path` is the file of `database`.
  MapArchive(storage::MapDatabase database, std::filesystem::path path);

  /// A local map that has come, as it was sent. Stored by the next flush(), if it is not yet.
  void add(const topomap::LocalMap& map);
  [[nodiscard]] bool has_batch() const { return queue_.size() >= kBatch; }
  [[nodiscard]] std::size_t queued() const { return queue_.size(); }

  /// Stores the local maps that have come. Returns those that differ from what is stored under
  /// their number. Throws std::runtime_error naming file and cause; what was not stored stays.
  std::vector<topomap::StopId> flush();

  /// Stores which stops the map has, their poses and the closures. `local_maps` begin with those
  /// that the map had before, unless the trajectory has numbered them anew: then those that it does
  /// not name leave the map. Throws like flush(), and std::invalid_argument when a local map is
  /// not stored.
  void put(std::span<const topomap::LocalMap> local_maps, const topomap::Trajectory& trajectory,
           std::span<const topomap::LoopClosure> closures);
  void put(const std::vector<storage::MapEdge>& edges);
  void put(const topomap::GlobalMap& map);
  void put(const storage::MapDrawing& drawing);
  void put(const std::vector<storage::RefusedMerge>& refused);
  void put(const planning::RoomMemory& rooms);

  [[nodiscard]] const storage::MapDatabase& database() const { return database_; }

 private:
  void remember(const topomap::Trajectory& trajectory,
                std::span<const topomap::LoopClosure> closures);
  /// Writes the file again if it was removed. Throws when another one is in its place.
  void check_file();

  storage::MapDatabase database_;
  std::filesystem::path path_;
  std::uint64_t file_ = 0;  // number of the open file on its disk
  std::vector<topomap::LocalMap> queue_;
  std::set<topomap::StopId> queued_;
  // These are of the trajectory that was put last. The version of a trajectory does not identify
  // its poses: while segments of it are on their way, it has older poses beside newer ones.
  std::uint64_t version_ = 0;
  std::uint64_t poses_ = 0;     // their hash
  std::uint64_t closures_ = 0;  // their hash
};

}  // namespace topogeo::map_store
