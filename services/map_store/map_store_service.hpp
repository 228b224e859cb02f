// Keeps the map of a robot: stores its input and acknowledges it, publishes the live map, serves it
// on request, and writes the map files at the end.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/store.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"
#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_document.hpp"

#include "archive_channel.hpp"
#include "drawing_channel.hpp"
#include "element_publisher.hpp"
#include "live_hybrid.hpp"
#include "live_map.hpp"
#include "map_archive.hpp"
#include "map_input.hpp"
#include "snapshot_queue.hpp"
#include "stored_channel.hpp"
#include "verdict_channel.hpp"

namespace topogeo::map_store {

struct MapStoreOptions {
  std::filesystem::path directory;
  std::filesystem::path database;                         ///< empty: map.sqlite in the directory
  std::string title;                                      ///< of the pictures
  std::shared_ptr<const storage::MapDocument> continued;  ///< map to extend; null: none
  storage::MapDrawing drawing;                            ///< laid over the map
};

/// Lives in the loop of its service.
class MapStoreService {
 public:
  /// Continues the map of `database`, which is that of `options.continued` where that is given.
  /// `options.directory` exists. Throws std::runtime_error when the map cannot be read or the
  /// drawing cannot be stored.
  MapStoreService(service::Service& service, MapStoreOptions options,
                  storage::MapDatabase database);

  /// Call it after the loop: writes the map files as far as the map is complete. Throws
  /// std::runtime_error naming the file.
  void end();

  /// Call it after the loop: the snapshot that replaces the map, if that ended the loop.
  [[nodiscard]] const std::optional<std::string>& wanted_snapshot() const {
    return wanted_snapshot_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  template <class T, class Handler>
  void listen(Handler handler, const service::Subscription& subscription = {});
  void on_local_map(const msg::LocalMap& message);

  /// Stores new data and acknowledges it; false, with a fault, when that fails. `all` includes the
  /// measurements, which are otherwise stored now and then.
  bool store(bool all = false);
  void store_edges(bool now);
  void storing_failed(const std::string& why);
  void write_snapshot(const msg::SnapshotRequest& request, const SnapshotQueue::Sink& sink);
  /// False when it was not sent.
  bool send_piece(const msg::SnapshotPiece& piece);
  /// Does a slice of work on the live map.
  void work_on_live_map();
  /// False when a part of it could not be sent.
  bool publish(const topomap::GlobalMap& map);
  /// Stores a part; false, with a fault, when that fails.
  template <class Part>
  bool keep(const Part& part);
  /// Builds and sends the hybrid map of the current data, when it is due.
  void publish_hybrid();
  [[nodiscard]] std::int64_t last_stamp_ns() const;
  /// Stores a drawing and publishes it soon. Throws std::runtime_error when it cannot be stored.
  void take_drawing(storage::MapDrawing drawing);
  void finish_if_complete();
  /// The map of a run, or the stored map when no stop joined the map to extend. Its rooms keep
  /// their remembered numbers.
  [[nodiscard]] storage::MapDocument final_document(const topomap::Trajectory& trajectory,
                                                    const planning::RoomMemory& rooms) const;
  void finish(const topomap::Trajectory& trajectory);
  void count();
  /// Reports faults for dropped local maps.
  void report_losses();

  service::Service& service_;
  MapStoreOptions options_;
  MapArchive archive_;
  std::optional<topomap::GlobalMap> shown_;  // stored map, shown until the live map is made
  planning::RoomMemory stored_rooms_;
  MapInput input_;
  VerdictChannel verdicts_;
  LiveMap live_map_;
  ElementPublisher elements_;
  LiveHybrid hybrid_;

  messaging::Writer<msg::StreamEnd> ends_out_;
  StoredChannel acknowledged_;
  messaging::Writer<msg::SnapshotPiece> pieces_out_;
  SnapshotQueue snapshots_;
  ArchiveChannel copies_;
  std::optional<std::string> wanted_snapshot_;
  DrawingChannel drawing_;

  Clock::time_point next_store_;  // after a failure
  Clock::time_point next_edges_;
  std::uint64_t stored_edges_ = 0;  // edge changes already stored
  std::size_t stored_refusals_ = 0;
  bool storing_fails_ = false;
  std::size_t published_maps_ = 0;
  std::uint64_t published_rebuilds_ = 0;
  std::uint64_t published_version_ = 0;
  Clock::time_point next_publish_;
  Clock::time_point next_attempt_;  // of finishing, after a failure
  bool finished_ = false;
  bool drawn_since_ = false;  // the map has changed since it was finished
};

}  // namespace topogeo::map_store
