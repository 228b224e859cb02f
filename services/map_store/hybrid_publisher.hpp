// Sends the hybrid map: the tiles that have changed, and its summary.
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
  /// Rooms keep the numbers that are remembered.
  explicit HybridPublisher(service::Service& service, planning::RoomMemory rooms = {});

  /// Makes the map with the configuration of the service and sends it. Without
  /// anything to make a grid of there is none; one that cannot be made or does not fit the messages
  /// is a fault. `stamp_ns` is of the last stop.
  void publish(const pipeline::HybridMapParts& parts, std::int64_t stamp_ns);

  /// The same with a map that is made. Throws std::invalid_argument when it does not fit the
  /// messages.
  void publish(const planning::HybridMap& map, std::int64_t stamp_ns);

  /// Tries what could not be sent once more. True when nothing is left.
  bool send_rest();

  /// Of the last one that was published; 0 before the first.
  [[nodiscard]] std::uint64_t version() const {
    return rest_.summary ? rest_.summary->version() : updates_.sent_version();
  }

  /// Goes on with other numbers of rooms.
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
