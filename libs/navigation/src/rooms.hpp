// The rooms of a map: its wide parts, independent of the graph. While a floor is being mapped,
// doors come and go in the graph, and two rooms are one zone until their door has been found.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::navigation {

class Rooms {
 public:
  /// The map must outlive it.
  explicit Rooms(const planning::HybridMap& map);

  [[nodiscard]] const std::vector<planning::Zone>& all() const { return rooms_.zones; }
  /// kNoZone for impassable cells, or outside.
  [[nodiscard]] planning::ZoneId at(const planning::Cell& cell) const;
  /// Whether one of the poses (map frame) lies inside of a room, not on its threshold.
  [[nodiscard]] bool entered(planning::ZoneId room, std::span<const geometry::Pose2> poses) const;
  /// The cell of a room farthest from obstacles; nothing for a room without cells.
  [[nodiscard]] std::optional<planning::Cell> widest(const planning::Zone& room) const;

 private:
  [[nodiscard]] bool on_threshold(const planning::Cell& cell, planning::ZoneId room) const;

  const planning::HybridMap& map_;
  planning::ZoneMap rooms_;
};

}  // namespace topogeo::navigation
