// Basis on which the parts of a route were planned (docs/navigation.md, "On branches or on the
// grid").
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace topogeo::planning {

enum class PlannedOn : std::uint8_t {
  kGrid = 0,           ///< cells of the grid
  kBranch = 1,         ///< a branch of the topo-geometric map
  kVirtualBranch = 2,  ///< a virtual branch: the robot has passed there but seen little
  kOffBranch = 3,      ///< a straight line between the start or the goal and a branch
};

/// Readable name: "grid", "branch", "virtual branch", "off branch".
std::string_view describe(PlannedOn on);

/// A part of a route, from its first point to the first point of the next part or to the end.
struct RoutePart {
  PlannedOn on = PlannedOn::kGrid;
  std::uint32_t branch_id = 0;  ///< MapBranch::id; 0 if it follows none
  std::size_t first_point = 0;  ///< index among the points of the route

  friend bool operator==(const RoutePart&, const RoutePart&) = default;
};

}  // namespace topogeo::planning
