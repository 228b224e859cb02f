// Walls, openings and doors as people draw them on a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::planning {

/// What a drawn line is for. The values are those of proto/map.proto and idl/drawing.idl.
enum class LineKind : std::uint8_t {
  kWall = 0,     ///< not to be crossed, though the map is free there
  kOpening = 1,  ///< a stretch of a wall, mapped or drawn, that is open
  kDoor = 2,     ///< an opening at which two rooms meet
};
inline constexpr std::size_t kLineKinds = 3;

/// A polyline; openings and doors have two points.
struct DrawnLine {
  LineKind kind = LineKind::kWall;
  std::vector<Eigen::Vector2d> points_m;  ///< at least two, in order, map frame
  std::string name{};                     ///< of a door; others may have none

  friend bool operator==(const DrawnLine&, const DrawnLine&) = default;
};

/// Walls are no thicker than twice this: so far on either side of an opening the floor is free.
inline constexpr double kOpeningReach_m = 0.3;

}  // namespace topogeo::planning
