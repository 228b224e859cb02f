// The live global map of one robot, kept from its elements.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::service {

class MapMirror {
 public:
  /// Takes an element. Throws std::invalid_argument like node_from_msg and branch_from_msg.
  void put(const msg::MapElement& element, const messaging::Handle& instance);

  /// Takes out the element of an instance that was disposed; one never put is no error.
  void remove(const messaging::Handle& instance);

  /// The map, if it is whole: as many nodes and branches as its summary counts and no branch with
  /// an end that is not there. Empty while an update is under way and before the first.
  [[nodiscard]] std::optional<topomap::GlobalMap> map() const;

 private:
  using Key = std::pair<msg::MapElementKind, std::uint32_t>;

  struct Summary {
    std::uint64_t version = 0;
    std::uint32_t nodes = 0;
    std::uint32_t branches = 0;
  };
  std::map<messaging::Handle, Key> keys_;
  std::map<std::uint32_t, topomap::MapNode> nodes_;
  std::map<std::uint32_t, topomap::MapBranch> branches_;
  std::optional<Summary> summary_;
};

}  // namespace topogeo::service
