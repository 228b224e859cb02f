// When the hybrid map of a map that is being made is made anew: now and then as the map grows, and
// at once when somebody draws.
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

  /// `map` is what there is of nodes and branches; nothing is due while there is nothing.
  LiveHybrid(service::Service& service, planning::RoomMemory rooms,
             std::optional<topomap::GlobalMap> map);

  /// What the next one is made of.
  void take(topomap::GlobalMap map);
  [[nodiscard]] const std::optional<topomap::GlobalMap>& map() const { return map_; }
  /// Another drawing: the next one is due at once, before there is a map, too.
  void redraw();

  /// Sends what is left of the last one. True when the next is to be made now.
  [[nodiscard]] bool due();
  /// Makes and sends the next one, which is due; `parts` lack the global map.
  void make(pipeline::HybridMapParts parts, std::int64_t stamp_ns);
  /// Of a run that is complete: the last one, whatever is due.
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
