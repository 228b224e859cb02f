// What people have drawn on a map: places and zones that have names, and an occupancy grid. With it
// goes what the robot has mapped itself; either can be missing.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::storage {

struct MapDrawing {
  std::vector<planning::Place> places;          ///< at most kMaxPlaces, in the order of the drawing
  std::vector<planning::DrawnZone> zones;       ///< at most kMaxDrawnZones, the same
  std::optional<planning::OccupancyGrid> grid;  ///< cells that are unknown are not drawn

  [[nodiscard]] bool empty() const { return places.empty() && zones.empty() && !grid; }
};

// What people draw by hand stays far below; a damaged file must not fill the memory.
inline constexpr std::size_t kMaxPlaces = 4096;
inline constexpr std::size_t kMaxDrawnZones = 4096;
inline constexpr std::size_t kMaxCorners = 65536;  ///< of a zone
inline constexpr std::size_t kMaxNameBytes = 64;

/// Throws std::runtime_error naming the entry, its value and what is allowed: too many entries, a
/// name that is empty, taken by another place or zone, longer than kMaxNameBytes or no printable
/// UTF-8, a coordinate that is not finite or beyond 1,000 km, a heading beyond pi, a zone of less
/// than three corners.
void check(const MapDrawing& drawing);

}  // namespace topogeo::storage
