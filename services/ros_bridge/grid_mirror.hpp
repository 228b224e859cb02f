// The occupancy grid of the map as ROS has it, kept from our tiles.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros_bridge {

class GridMirror {
 public:
  /// Throw std::invalid_argument naming the field when the message contradicts itself; the mirror
  /// is then as before.
  void put(const msg::GridTile& tile, messaging::Handle instance);
  void put(const msg::HybridMap& summary);
  void remove(messaging::Handle instance);

  /// What changed with the last whole map.
  struct Change {
    bool whole = false;       ///< size or place of the grid, or it is the first
    std::int32_t column = 0;  ///< of the rectangle that changed
    std::int32_t row = 0;
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
  };
  /// Takes the newest map over, once every tile has come with the version of the summary. Empty
  /// when there is none that is new or nothing in it has changed.
  std::optional<Change> take();

  /// Of what `take` gave; nothing before the first.
  [[nodiscard]] bool has_map() const { return map_.has_value(); }
  [[nodiscard]] ros::OccupancyGrid grid(const std::string& frame, std::int64_t stamp_ns) const;
  [[nodiscard]] ros::OccupancyGridUpdate update(const Change& change, const std::string& frame,
                                                std::int64_t stamp_ns) const;
  /// The summary of the same map.
  [[nodiscard]] const msg::HybridMap& summary() const { return *map_; }
  /// The middle of a cell of each zone, the one nearest to the middle of them all; map frame. Empty
  /// for a zone without cells.
  [[nodiscard]] std::vector<std::optional<msg::Point2>> zone_middles() const;

 private:
  struct Tile {
    std::uint64_t version = 0;
    std::vector<std::int8_t> cells;  // as ROS has them
    std::vector<std::uint16_t> zones;
  };

  [[nodiscard]] bool whole() const;
  void copy(const Tile& tile, std::uint32_t number);

  std::map<messaging::Handle, std::uint32_t> keys_;
  std::map<std::uint32_t, Tile> tiles_;
  std::optional<msg::HybridMap> summary_;  // the newest
  std::optional<msg::HybridMap> map_;      // the newest that was whole
  std::vector<std::int8_t> cells_;         // of it, row by row from the lower left one
};

}  // namespace topogeo::ros_bridge
