// Nodes and branches of the map on the hub.
#pragma once

#include <string>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "server/channel_hub.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class GraphView {
 public:
  GraphView(service::Service& service, ChannelHub& hub);

  /// The newest complete map, for routes; null before the first. Throws std::invalid_argument like
  /// from_elements.
  std::shared_ptr<const topomap::GlobalMap> map();

 private:
  void show();

  ChannelHub& hub_;
  map_client::MapFollower follower_;
  bool changed_ = false;  // since the last call of map()
  std::shared_ptr<const topomap::GlobalMap> map_;
};

}  // namespace topogeo::web
