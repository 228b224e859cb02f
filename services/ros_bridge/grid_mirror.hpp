// The occupancy grid of the map in ROS's format, assembled from our tiles.
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
  /// is then unchanged.
  void put(const msg::GridTile& tile, messaging::Handle instance);
  void put(const msg::HybridMap& summary);
  void remove(messaging::Handle instance);

  /// The difference between the last two complete maps.
  struct Change {
    bool whole = false;       ///< size or place of the grid differs, or this is the first map
    std::int32_t column = 0;  ///< of the changed rectangle
    std::int32_t row = 0;
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
  };
  /// Takes the newest map once every tile has arrived with the version of the summary. Empty when
  /// there is no new map or nothing in it has changed.
  std::optional<Change> take();

  /// Whether take() has returned a map.
  [[nodiscard]] bool has_map() const { return map_.has_value(); }
  [[nodiscard]] ros::OccupancyGrid grid(const std::string& frame, std::int64_t stamp_ns) const;
  [[nodiscard]] ros::OccupancyGridUpdate update(const Change& change, const std::string& frame,
                                                std::int64_t stamp_ns) const;
  /// The summary of the same map.
  [[nodiscard]] const msg::HybridMap& summary() const { return *map_; }
  /// For each zone, the middle of the cell nearest to the centroid of its cells; map frame. Empty
  /// for a zone without cells.
  [[nodiscard]] std::vector<std::optional<msg::Point2>> zone_middles() const;

 private:
  struct Tile {
    std::uint64_t version = 0;
    std::vector<std::int8_t> cells;  // in ROS's values
    std::vector<std::uint16_t> zones;
  };

  [[nodiscard]] bool whole() const;
  void copy(const Tile& tile, std::uint32_t number);

  std::map<messaging::Handle, std::uint32_t> keys_;
  std::map<std::uint32_t, Tile> tiles_;
  std::optional<msg::HybridMap> summary_;  // the newest
  std::optional<msg::HybridMap> map_;      // the newest complete one
  std::vector<std::int8_t> cells_;         // of map_, row by row from the lower left one
};

}  // namespace topogeo::ros_bridge
