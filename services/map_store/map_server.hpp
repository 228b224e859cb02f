// Publishes a finished or drawn map to all readers, and serves it on request.
#pragma once

#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/storage/map_document.hpp"

#include "archive_channel.hpp"
#include "drawing_channel.hpp"
#include "element_publisher.hpp"
#include "hybrid_publisher.hpp"
#include "snapshot_queue.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class MapServer {
 public:
  /// Sends both maps. `hybrid` was made from `document`. Throws std::invalid_argument when a map
  /// does not fit the messages.
  MapServer(service::Service& service, storage::MapDocument document,
            const planning::HybridMap& hybrid);

 private:
  /// Sends the parts that could not be sent before.
  void send();
  void announce();

  service::Service& service_;
  storage::MapDocument document_;
  std::int64_t stamp_ns_ = 0;  // of the map's last stop
  ElementPublisher elements_;
  HybridPublisher hybrid_;
  messaging::Writer<msg::StoredMap> stored_out_;
  messaging::Writer<msg::SnapshotPiece> pieces_out_;
  SnapshotQueue snapshots_;
  ArchiveChannel copies_;  // refuses all requests: there is no database
  DrawingChannel drawing_;
  bool announced_ = false;
  bool elements_sent_ = false;
};

}  // namespace topogeo::map_store
