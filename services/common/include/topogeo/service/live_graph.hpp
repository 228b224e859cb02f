// The live topo-geometric map of one robot, read from its topic.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::service {

class LiveGraph {
 public:
  /// Follows the robot whose map the service uses; lives in the service's loop.
  explicit LiveGraph(Service& service) : follower_(map_robot(service)) {
    using messaging::SampleInfo;
    service.subscribe<msg::MapElement>(
        [this](const msg::MapElement& element, const SampleInfo& info) {
          changed_ |= follower_.put(element, info.instance.bytes, info.writer.bytes);
        },
        {.of_map = true},
        [this](const SampleInfo& info) {
          if (info.state != messaging::InstanceState::kDisposed) return;
          changed_ |= follower_.remove(info.instance.bytes, info.writer.bytes);
        });
  }
  LiveGraph(const LiveGraph&) = delete;
  LiveGraph& operator=(const LiveGraph&) = delete;

  /// The newest complete map; null before the first. The object changes only when the map has
  /// changed. Throws std::invalid_argument like from_elements, once for each map; the previous map
  /// stays.
  std::shared_ptr<const topomap::GlobalMap> map() {
    if (std::exchange(changed_, false)) {
      map_ = std::make_shared<const topomap::GlobalMap>(from_elements(*follower_.map()));
    }
    return map_;
  }

 private:
  static std::string map_robot(const Service& service) {
    const std::string& other = service.setup().options.map_robot;
    return other.empty() ? service.robot_id() : other;
  }

  map_client::MapFollower follower_;
  bool changed_ = false;
  std::shared_ptr<const topomap::GlobalMap> map_;
};

}  // namespace topogeo::service
