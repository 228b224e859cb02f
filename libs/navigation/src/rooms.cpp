#include "rooms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace topogeo::navigation {

using planning::Cell;

Rooms::Rooms(const planning::HybridMap& map)
    : map_(map), rooms_(planning::zones_by_width(map.space())) {}

planning::ZoneId Rooms::at(const Cell& cell) const {
  return map_.frame().contains(cell) ? rooms_.zone_of_cell[map_.frame().index(cell)]
                                     : planning::kNoZone;
}

// Whether passable cells of another room are near.
bool Rooms::on_threshold(const Cell& cell, planning::ZoneId room) const {
  constexpr double kThreshold_m = 0.5;  // from there a laser sees little of a room
  const auto reach =
      static_cast<std::int32_t>(std::lround(kThreshold_m / map_.frame().resolution_m));
  for (std::int32_t y = -reach; y <= reach; ++y) {
    for (std::int32_t x = -reach; x <= reach; ++x) {
      if (x * x + y * y > reach * reach) continue;
      const planning::ZoneId other = at({cell.column + x, cell.row + y});
      if (other != planning::kNoZone && other != room) return true;
    }
  }
  return false;
}

bool Rooms::entered(planning::ZoneId room, std::span<const geometry::Pose2> poses) const {
  return std::any_of(poses.begin(), poses.end(), [&](const geometry::Pose2& pose) {
    const auto cell = map_.frame().cell_of(pose.position_m());
    return cell && at(*cell) == room && !on_threshold(*cell, room);
  });
}

std::optional<Cell> Rooms::widest(const planning::Zone& room) const {
  std::optional<Cell> best;
  for (std::int32_t row = room.box.low.row; row <= room.box.high.row; ++row) {
    for (std::int32_t column = room.box.low.column; column <= room.box.high.column; ++column) {
      const Cell cell{column, row};
      if (at(cell) != room.id) continue;
      if (!best || map_.space().clearance_m(cell) > map_.space().clearance_m(*best)) best = cell;
    }
  }
  return best;
}

}  // namespace topogeo::navigation
