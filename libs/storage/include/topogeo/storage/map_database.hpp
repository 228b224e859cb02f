// A map in an SQLite file, written while the robot drives; it outlives any process.
//
// A stop is identified by its session and its number there, as its local mapper sent it; the map
// itself numbers the stops that joined it. Write-ahead log with synchronous=FULL: the changes of a
// completed call survive the death of the process and the loss of power at any moment. Every call
// is one transaction, so a reader never sees a partial change. Elements are Protobuf blobs as in
// proto/map.proto; only changes are written.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/storage/map_document.hpp"

namespace SQLite {  // NOLINT(readability-identifier-naming): not ours
class Database;
}

namespace topogeo::storage {

class MapTables;
class StopTables;

/// A stop that joins the map.
struct JoinedStop {
  topomap::StopId stop;
  bool starts_drive = false;  ///< see topomap::numbered
};

/// Stored state of a session.
struct SessionState {
  std::uint64_t id = 0;
  std::uint32_t stops = 0;       ///< all stops below this number were received ...
  std::uint32_t first_kept = 0;  ///< ... and those below this one that did not join were dropped
  std::uint32_t joined = 0;      ///< its stops in the map
  bool is_over = false;          ///< it came with a whole map: its local mapper does not continue
};

/// For one thread. Every call throws std::runtime_error naming the file and the cause if the file
/// is damaged, the disk is full or another program holds the lock for longer than the patience; the
/// database is then unchanged.
class MapDatabase {
 public:
  static constexpr std::int64_t kSchemaVersion = 4;

  /// Opens the map of a robot, or creates it (an empty file counts as missing). Upgrades a file of
  /// an older version. Throws std::runtime_error if the file is no topogeo map database, is of a
  /// newer version or of another robot or seed, or is damaged.
  static MapDatabase open_or_create(const std::filesystem::path& path, const std::string& robot_id,
                                    std::uint64_t seed);

  /// Opens an existing database of any robot. Throws as above, also if there is none.
  static MapDatabase open_existing(const std::filesystem::path& path);

  /// The same for reading only: the file and its directory need not be writable and are not
  /// changed, even if the file is of an older version or another program writes it.
  static MapDatabase open_read_only(const std::filesystem::path& path);

  /// Throws std::runtime_error if the file is neither a map database, of any robot, nor an SQLite
  /// file without content, which a program leaves if it is stopped while creating one.
  static void check_replaceable(const std::filesystem::path& path);

  MapDatabase(MapDatabase&&) noexcept;
  MapDatabase& operator=(MapDatabase&&) noexcept;
  ~MapDatabase();

  /// How long a call waits for another program to finish its transaction; 5 s at first.
  void set_patience(std::chrono::milliseconds patience);

  /// Stores stops as they were sent, in any order: their ids are their numbers in their sessions.
  /// Ignores stops that are already stored or were dropped. Returns the stops that differ from the
  /// one stored under their number, which is kept. Throws std::invalid_argument if a stop has no
  /// robot or no session; nothing is stored then.
  std::vector<topomap::StopId> put_stops(std::span<const topomap::LocalMap> stops);

  /// Gives the next numbers of the map to these stops. Throws std::invalid_argument if one is not
  /// stored or already has a number.
  void join(std::span<const JoinedStop> stops);

  /// Drops stops that have not joined the map, the oldest first, until at most `most` are left.
  /// They are not accepted again. Returns the number of dropped stops.
  std::size_t drop_waiting(std::size_t most);

  /// Likewise drops the stops of a session that have not joined the map.
  void drop_session(std::uint64_t session);

  /// Frees the space of dropped data.
  void compact();

  /// Stores corrected poses of stops of the map, and the whole list of loop closures. Stops that
  /// are not in `changed` keep their pose; `joined` get the next numbers of the map first, like in
  /// join(). Throws std::invalid_argument if `version` is older than the stored one or a stop is
  /// not in the map.
  void put_trajectory(std::uint64_t version, std::span<const topomap::StopPose> changed,
                      std::span<const topomap::LoopClosure> closures,
                      std::span<const JoinedStop> joined = {});

  /// Removes stops from the map: `stops` are all that remain, in this order, with the poses of a
  /// trajectory that has renumbered them. The others are removed permanently and are not accepted
  /// again; the same holds for stops of a session before its last one in the map. Throws like
  /// put_trajectory().
  void renew(const topomap::Trajectory& trajectory, std::span<const topomap::LoopClosure> closures,
             std::span<const JoinedStop> stops);

  /// Replaces the edges that the trajectory was made from. Throws std::invalid_argument if a stop
  /// is not in the map.
  void put_edges(const std::vector<MapEdge>& edges);

  /// Replaces the stored global map. Throws std::invalid_argument if ids do not ascend or a branch
  /// ends at a node that is not in the map.
  void put_global_map(const topomap::GlobalMap& map);

  /// Replaces the drawing of the map. Throws std::invalid_argument where check(MapDrawing) does.
  void put_drawing(const MapDrawing& drawing);

  /// Replaces the list of refused merges.
  void put_refused_merges(std::span<const RefusedMerge> refused);

  /// Replaces the memory of the rooms. Throws std::invalid_argument for numbers that do not ascend
  /// from 1 to at most `last`.
  void put_rooms(const planning::RoomMemory& rooms);

  /// Replaces the evidence of the decisions about loops. Throws std::invalid_argument if a stop is
  /// not in the map. renew() removes them, because it renumbers the stops.
  void put_loop_verdicts(const std::vector<LoopVerdict>& verdicts);

  /// Stores a whole map in a database without stops, identified() first. Throws
  /// std::invalid_argument if there are stops or the map contradicts itself.
  void put_document(const MapDocument& document);

  /// The whole map, checked.
  [[nodiscard]] MapDocument load() const;

  /// The bytes of a map file of load(), piece by piece, so that the local maps are never all in
  /// memory at once.
  void write_map_file(const std::function<void(std::string_view)>& sink) const;
  /// The bytes of local_maps_bytes() for the stops of a session from number `first` on, in the map
  /// or not, piece by piece. Returns the number of stops.
  std::size_t write_local_maps(std::uint64_t session, std::uint32_t first,
                               const std::function<void(std::string_view)>& sink) const;

  /// A stop as it was sent; empty if it is not stored.
  [[nodiscard]] std::optional<topomap::LocalMap> stop(const topomap::StopId& stop) const;
  /// See put_loop_verdicts().
  [[nodiscard]] std::vector<LoopVerdict> loop_verdicts() const;
  /// Stored stops that have not joined the map, by order of the sessions and number.
  [[nodiscard]] std::vector<topomap::StopId> waiting_stops() const;
  [[nodiscard]] std::size_t waiting_count() const;
  /// Whether it is stored or was dropped.
  [[nodiscard]] bool knows(const topomap::StopId& stop) const;
  /// The sessions in the order of their arrival.
  [[nodiscard]] std::vector<SessionState> sessions() const;

  /// Number of stops in the map, which is the number that the next one gets.
  [[nodiscard]] std::uint32_t local_map_count() const;
  [[nodiscard]] std::uint64_t trajectory_version() const;
  /// See topomap::Trajectory.
  [[nodiscard]] std::uint64_t numbered_since() const;
  [[nodiscard]] const std::string& robot_id() const { return robot_id_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  /// 0 before the first stop.
  [[nodiscard]] std::uint64_t map_id() const { return map_id_; }

  /// Copies the database to `path`, which must not exist, whatever happened to its own file since.
  void copy_to(const std::filesystem::path& path) const;

 private:
  MapDatabase(const std::filesystem::path& path, std::unique_ptr<SQLite::Database> database);
  void create(const std::string& robot_id, std::uint64_t seed);
  void migrate();
  void read_state();
  /// Reads the cached state of the tables.
  void read_tables();
  /// Runs `work` as one transaction: an exception leaves no changes.
  template <typename Work>
  void change(const Work& work);
  // Parts of a transaction.
  std::vector<topomap::StopId> write_stops(std::span<const topomap::LocalMap> stops);
  void write_document(const MapDocument& document);
  void write_map_id(std::uint64_t map_id);

  std::string name_;
  std::unique_ptr<SQLite::Database> database_;
  std::unique_ptr<StopTables> stops_;
  std::unique_ptr<MapTables> tables_;
  bool tables_are_known_ = false;  // false: the cached state differs from the stored one
  std::string robot_id_;
  std::uint64_t seed_ = 0;
  std::uint64_t map_id_ = 0;
};

/// Size on disk, including the log of changes not yet in the file; 0 if there is none.
std::uintmax_t database_bytes(const std::filesystem::path& path);

}  // namespace topogeo::storage
