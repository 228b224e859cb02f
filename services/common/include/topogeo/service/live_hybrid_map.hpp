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

namespace topogeo::service {

class LiveHybridMap {
 public:
  /// Lives in the loop. For each tile and summary that comes it calls take(message, what, use),
  /// which passes over messages of other robots and calls use(message) for the others; that throws
  /// std::invalid_argument like HybridMapMirror::put. See Service::take.
  template <class Take>
  LiveHybridMap(const messaging::Participant& participant, messaging::EventLoop& loop, Take take)
      : tiles_(participant), summaries_(participant) {
    using messaging::SampleInfo;
    // A map_store that has gone leaves its last map standing; only a disposal takes away.
    loop.add<msg::GridTile>(
        tiles_,
        [this, take](const msg::GridTile& message, const SampleInfo& info) {
          take(message, "grid tile",
               [&](const msg::GridTile& tile) { mirror_.put(tile, info.instance); });
        },
        [this](const SampleInfo& info) {
          if (info.state == messaging::InstanceState::kDisposed) mirror_.remove(info.instance);
        });
    loop.add<msg::HybridMap>(
        summaries_,
        [this, take](const msg::HybridMap& message, const SampleInfo&) {
          take(message, "hybrid map", [&](const msg::HybridMap& summary) { mirror_.put(summary); });
        },
        [this](const SampleInfo& info) {
          if (info.state == messaging::InstanceState::kDisposed) mirror_.remove_summary();
        });
  }
  LiveHybridMap(const LiveHybridMap&) = delete;
  LiveHybridMap& operator=(const LiveHybridMap&) = delete;

  /// As HybridMapMirror::map and version.
  std::shared_ptr<const planning::HybridMap> map() { return mirror_.map(); }
  [[nodiscard]] std::uint64_t version() const { return mirror_.version(); }

 private:
  HybridMapMirror mirror_;
  messaging::Reader<msg::GridTile> tiles_;
  messaging::Reader<msg::HybridMap> summaries_;
};

}  // namespace topogeo::service
