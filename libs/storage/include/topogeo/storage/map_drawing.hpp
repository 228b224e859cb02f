// Everything that people have drawn on a map: named places and zones, walls, openings and doors,
// and an occupancy grid. It complements the map made by the robot; either can be missing.
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
  std::optional<planning::OccupancyGrid> grid;  ///< unknown cells are not drawn
  std::uint64_t version = 0;                    ///< counts the changes of a live map

  /// Whether nothing was ever drawn.
  [[nodiscard]] bool empty() const {
    return places.empty() && zones.empty() && lines.empty() && !grid && version == 0;
  }
};

// Limits far above hand-drawn maps, so that a damaged file cannot fill the memory.
inline constexpr std::size_t kMaxPlaces = 4096;
inline constexpr std::size_t kMaxDrawnZones = 4096;
inline constexpr std::size_t kMaxDrawnLines = 4096;
inline constexpr std::size_t kMaxCorners = 65536;  ///< of a zone or line
inline constexpr std::size_t kMaxNameBytes = 64;

/// A forbidden entry of a drawing: what() names it.
class DrawingError : public std::runtime_error {
 public:
  /// `list` is "places", "zones", "walls", "openings" or "doors"; `index` counts the entries of
  /// that list only.
  DrawingError(std::string list, std::size_t index, const std::string& what)
      : std::runtime_error(what), list_(std::move(list)), index_(index) {}

  [[nodiscard]] const std::string& list() const { return list_; }
  [[nodiscard]] std::size_t index() const { return index_; }

 private:
  std::string list_;
  std::size_t index_;
};

/// "walls[2]: ...", for users of the lists.
std::string located(const DrawingError& error);

/// The list for a kind of lines: "walls", ...
const char* list_of(planning::LineKind kind);

/// Throws DrawingError or, for too many entries, std::runtime_error naming the entry, its value and
/// the allowed values: too many entries, a name that is empty, used by another place or zone,
/// longer than kMaxNameBytes or not printable UTF-8, a coordinate that is not finite or beyond
/// 1,000 km, a heading beyond pi, a zone of fewer than three corners, a wall of fewer than two
/// points, an opening or door without exactly two points or without length.
void check(const MapDrawing& drawing);

}  // namespace topogeo::storage
