// Walls, openings and doors as people draw them on a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::planning {

/// Kind of a drawn line. The values are those of proto/map.proto and idl/drawing.idl.
enum class LineKind : std::uint8_t {
  kWall = 0,     ///< must not be crossed, even if the map is free there
  kOpening = 1,  ///< an open part of a mapped or drawn wall
  kDoor = 2,     ///< an opening at which two rooms meet
};
inline constexpr std::size_t kLineKinds = 3;

/// A polyline; openings and doors have two points.
struct DrawnLine {
  LineKind kind = LineKind::kWall;
  std::vector<Eigen::Vector2d> points_m;  ///< at least two, in order, map frame
  std::string name{};                     ///< of a door; optional for others

  friend bool operator==(const DrawnLine&, const DrawnLine&) = default;
};

/// Half of the largest thickness of walls: the floor is free this far on either side of an opening.
inline constexpr double kOpeningReach_m = 0.3;

}  // namespace topogeo::planning
