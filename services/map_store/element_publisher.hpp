// Sends the changed elements of the global map.
#pragma once

#include <cstdint>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/service/service.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "element_updates.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class ElementPublisher {
 public:
  explicit ElementPublisher(service::Service& service);

  /// `stamp_ns` is that of the last stop in the map. Returns false when something could not be
  /// sent: call it again.
  bool publish(const topomap::GlobalMap& map, std::uint64_t map_id, std::int64_t stamp_ns);

 private:
  bool send(msg::MapElement& element);

  service::Service& service_;
  ElementUpdates updates_;
  messaging::Writer<msg::MapElement> elements_;
};

}  // namespace topogeo::map_store
