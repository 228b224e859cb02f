// Sends the hybrid map: its changed tiles and its summary.
#pragma once

#include <cstdint>
#include <utility>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/service/service.hpp"

#include "hybrid_updates.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class HybridPublisher {
 public:
  /// Rooms keep their remembered numbers.
  explicit HybridPublisher(service::Service& service, planning::RoomMemory rooms = {});

  /// Builds the map with the configuration of the service and sends it. Nothing is sent when there
  /// is nothing to make a grid of; a map that cannot be built or does not fit the messages is a
  /// fault. `stamp_ns` is that of the last stop.
  void publish(const pipeline::HybridMapParts& parts, std::int64_t stamp_ns);

  /// Sends an existing map in the same way. Throws std::invalid_argument when it does not fit the
  /// messages.
  void publish(const planning::HybridMap& map, std::int64_t stamp_ns);

  /// Retries everything that could not be sent. True when nothing is left.
  bool send_rest();

  /// Version of the map published last; 0 before the first.
  [[nodiscard]] std::uint64_t version() const {
    return rest_.summary ? rest_.summary->version() : updates_.sent_version();
  }

  /// Continues with other room numbers.
  void remember(planning::RoomMemory rooms) { rooms_ = planning::RoomNumbers(std::move(rooms)); }
  [[nodiscard]] const planning::RoomMemory& rooms() const { return rooms_.memory(); }

 private:
  service::Service& service_;
  planning::RoomNumbers rooms_;
  HybridUpdates updates_;
  HybridUpdates::Update rest_;
  messaging::Writer<msg::GridTile> tiles_;
  messaging::Writer<msg::HybridMap> summaries_;
};

}  // namespace topogeo::map_store
