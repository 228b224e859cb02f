// What people have drawn on a map: places and zones that have names, walls, openings and doors, and
// an occupancy grid. With it goes what the robot has mapped itself; either can be missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::storage {

struct MapDrawing {
  std::vector<planning::Place> places;          ///< at most kMaxPlaces, in the order of the drawing
  std::vector<planning::DrawnZone> zones;       ///< at most kMaxDrawnZones, the same
  std::vector<planning::DrawnLine> lines;       ///< at most kMaxDrawnLines, the same
  std::optional<planning::OccupancyGrid> grid;  ///< cells that are unknown are not drawn
  std::uint64_t version = 0;                    ///< counts the changes made of a live map

  /// Nothing was ever drawn.
  [[nodiscard]] bool empty() const {
    return places.empty() && zones.empty() && lines.empty() && !grid && version == 0;
  }
};

// What people draw by hand stays far below; a damaged file must not fill the memory.
inline constexpr std::size_t kMaxPlaces = 4096;
inline constexpr std::size_t kMaxDrawnZones = 4096;
inline constexpr std::size_t kMaxDrawnLines = 4096;
inline constexpr std::size_t kMaxCorners = 65536;  ///< of a zone or line
inline constexpr std::size_t kMaxNameBytes = 64;

/// An entry of a drawing that is not allowed: what() names it.
class DrawingError : public std::runtime_error {
 public:
  /// `list` is "places", "zones", "walls", "openings" or "doors"; `index` counts the entries of
  /// that list alone.
  DrawingError(std::string list, std::size_t index, const std::string& what)
      : std::runtime_error(what), list_(std::move(list)), index_(index) {}

  [[nodiscard]] const std::string& list() const { return list_; }
  [[nodiscard]] std::size_t index() const { return index_; }

 private:
  std::string list_;
  std::size_t index_;
};

/// "walls[2]: ...", for those who have the lists before them.
std::string located(const DrawingError& error);

/// The list of lines of a kind: "walls", ...
const char* list_of(planning::LineKind kind);

/// Throws DrawingError or, of too many entries, std::runtime_error naming the entry, its value and
/// what is allowed: too many entries, a name that is empty, taken by another place or zone, longer
/// than kMaxNameBytes or no printable UTF-8, a coordinate that is not finite or beyond 1,000 km, a
/// heading beyond pi, a zone of less than three corners, a wall of less than two points, an opening
/// or door of other than two, or of no length.
void check(const MapDrawing& drawing);

}  // namespace topogeo::storage
