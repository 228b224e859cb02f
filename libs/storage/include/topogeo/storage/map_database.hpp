// The map of one robot in an SQLite file, written while the robot drives.
//
// Write-ahead log with synchronous=NORMAL: whatever a call here returned from survives the death of
// the process at any moment. A power cut may take the last transactions but leaves a consistent
// earlier state; forcing each transaction to disk would cost a disk flush for each stop, and the
// localizer re-sends what is missing. Every put is one transaction, so a reader never sees a half.
// Elements are Protobuf blobs as in proto/map.proto; only what has changed is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "topogeo/storage/map_document.hpp"

namespace SQLite {  // NOLINT(readability-identifier-naming): not ours
class Database;
}

namespace topogeo::storage {

/// For one thread. Every call throws std::runtime_error naming the file and the cause when the file
/// is damaged, the disk is full or another program holds the lock for more than five seconds; the
/// database is then as before the call.
class MapDatabase {
 public:
  /// Opens the database of a robot's run, or creates it (an empty file counts as none). Throws
  /// std::runtime_error when the file is no topogeo map database, is of a newer version or of
  /// another robot or seed, or is damaged.
  static MapDatabase open_or_create(const std::filesystem::path& path, const std::string& robot_id,
                                    std::uint64_t seed);

  /// Opens an existing database of any robot. Throws as above, also when there is none.
  static MapDatabase open_existing(const std::filesystem::path& path);

  /// Throws std::runtime_error when the file is neither a map database, of whatever robot, nor an
  /// SQLite file without content, as a program leaves that was stopped while it created one.
  static void check_replaceable(const std::filesystem::path& path);

  MapDatabase(MapDatabase&&) noexcept;
  MapDatabase& operator=(MapDatabase&&) noexcept;
  ~MapDatabase();

  /// Stores the map of the next stop. Storing a map again changes nothing. Throws
  /// std::invalid_argument when the map is of another robot, leaves out a stop or differs from the
  /// one stored under its id.
  void put_local_map(const topomap::LocalMap& map);

  /// Stores corrected poses of stops whose maps are stored, and the whole list of loop closures.
  /// Stops that are not in `changed` keep their pose. Throws std::invalid_argument when `version`
  /// is older than the stored one or a stop has no local map.
  void put_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                      std::span<const topomap::LoopClosure> closures);

  /// Makes the stored global map this one. Throws std::invalid_argument when ids do not ascend or a
  /// branch ends at a node that is not in the map.
  void put_global_map(const topomap::GlobalMap& map);

  /// Makes this the drawing of the map. Throws std::invalid_argument where check(MapDrawing) does.
  void put_drawing(const MapDrawing& drawing);

  /// Everything stored, checked.
  [[nodiscard]] MapDocument load() const;

  /// Stops stored, the id that the next local map must have.
  [[nodiscard]] std::uint32_t local_map_count() const { return local_map_count_; }
  [[nodiscard]] std::uint64_t trajectory_version() const { return trajectory_version_; }
  [[nodiscard]] const std::string& robot_id() const { return robot_id_; }

 private:
  /// Hash of each stored blob of a table by id, to write only what has changed.
  using BlobHashes = std::map<std::uint32_t, std::uint64_t>;

  MapDatabase(const std::filesystem::path& path, bool may_create);
  void create_schema(const std::string& robot_id, std::uint64_t seed);
  void read_state();
  void read_hashes(const char* table, BlobHashes& hashes);

  std::string name_;
  std::unique_ptr<SQLite::Database> database_;
  std::string robot_id_;
  std::uint64_t seed_ = 0;
  std::uint64_t trajectory_version_ = 0;
  std::uint32_t local_map_count_ = 0;
  BlobHashes stop_hashes_;
  BlobHashes closure_hashes_;
  BlobHashes node_hashes_;
  BlobHashes branch_hashes_;
};

}  // namespace topogeo::storage
