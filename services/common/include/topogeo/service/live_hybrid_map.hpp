// The live hybrid map of one robot, read from its topics.
#pragma once

#include <cstdint>
#include <memory>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/service/hybrid_map_mirror.hpp"
#include "topogeo/service/service.hpp"

namespace topogeo::service {

class LiveHybridMap {
 public:
  /// Follows the robot whose map the service uses; lives in the service's loop.
  explicit LiveHybridMap(Service& service) {
    service.subscribe<msg::GridTile>(
        [this](const msg::GridTile& tile, const messaging::SampleInfo& info) { put(tile, info); },
        {.of_map = true}, [this](const messaging::SampleInfo& info) { remove_tile(info); });
    service.subscribe<msg::HybridMap>(
        [this](const msg::HybridMap& summary) { mirror_.put(summary); }, {.of_map = true},
        [this](const messaging::SampleInfo& info) { remove_summary(info); });
  }

  /// For programs that are no service; lives in the loop. Each tile and summary is passed to
  /// take(message, use), which ignores messages of other robots and calls use(message) for the
  /// rest; `use` throws std::invalid_argument like HybridMapMirror::put.
  template <class Take>
  LiveHybridMap(const messaging::Participant& participant, messaging::EventLoop& loop, Take take) {
    loop.add<msg::GridTile>(
        messaging::Reader<msg::GridTile>(participant),
        [this, take](const msg::GridTile& message, const messaging::SampleInfo& info) {
          take(message, [&](const msg::GridTile& tile) { put(tile, info); });
        },
        [this](const messaging::SampleInfo& info) { remove_tile(info); });
    loop.add<msg::HybridMap>(
        messaging::Reader<msg::HybridMap>(participant),
        [this, take](const msg::HybridMap& message, const messaging::SampleInfo&) {
          take(message, [&](const msg::HybridMap& summary) { mirror_.put(summary); });
        },
        [this](const messaging::SampleInfo& info) { remove_summary(info); });
  }
  LiveHybridMap(const LiveHybridMap&) = delete;
  LiveHybridMap& operator=(const LiveHybridMap&) = delete;

  /// Same as HybridMapMirror::map and version.
  std::shared_ptr<const planning::HybridMap> map() { return mirror_.map(); }
  [[nodiscard]] std::uint64_t version() const { return mirror_.version(); }

 private:
  void put(const msg::GridTile& tile, const messaging::SampleInfo& info) {
    mirror_.put(tile, info.instance);
  }
  // The last map survives a map_store that has gone; only a disposal removes it.
  void remove_tile(const messaging::SampleInfo& info) {
    if (info.state == messaging::InstanceState::kDisposed) mirror_.remove(info.instance);
  }
  void remove_summary(const messaging::SampleInfo& info) {
    if (info.state == messaging::InstanceState::kDisposed) mirror_.remove_summary();
  }

  HybridMapMirror mirror_;
};

}  // namespace topogeo::service
