// Decides when to rebuild the hybrid map of a growing map: now and then as the map grows, and at
// once when people draw.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "hybrid_publisher.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class LiveHybrid {
 public:
  using Clock = std::chrono::steady_clock;

  /// `map` has the nodes and branches so far; without it nothing is due.
  LiveHybrid(service::Service& service, planning::RoomMemory rooms,
             std::optional<topomap::GlobalMap> map);

  /// Sets the global map for the next hybrid map.
  void take(topomap::GlobalMap map);
  [[nodiscard]] const std::optional<topomap::GlobalMap>& map() const { return map_; }
  /// The drawing has changed: the next map is due at once, even before there is a global map.
  void redraw();

  /// Sends the rest of the last map. True when the next one is due now.
  [[nodiscard]] bool due();
  /// Builds and sends the next map; `parts` lack the global map.
  void make(pipeline::HybridMapParts parts, std::int64_t stamp_ns);
  /// Sends the last map of a complete run, whether due or not.
  void finish(const pipeline::HybridMapParts& parts, std::int64_t stamp_ns);

  void remember(planning::RoomMemory rooms) { publisher_.remember(std::move(rooms)); }
  [[nodiscard]] std::uint64_t version() const { return publisher_.version(); }
  [[nodiscard]] const planning::RoomMemory& rooms() const { return publisher_.rooms(); }

 private:
  HybridPublisher publisher_;
  std::optional<topomap::GlobalMap> map_;
  bool due_ = false;
  Clock::time_point next_;
};

}  // namespace topogeo::map_store
