// Converts occupancy grids to ROS (nav_msgs/OccupancyGrid).
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros {

inline constexpr std::int8_t kFreeCell = 0;
inline constexpr std::int8_t kOccupiedCell = 100;
inline constexpr std::int8_t kUnknownCell = -1;

/// Converts our cell states: 0 free, 1 occupied, any other unknown.
std::int8_t cell_of(std::uint8_t state);

/// Size and pose: T_map_grid takes the corner of cell (0, 0) and the directions of columns and rows
/// to the map frame.
struct GridPlace {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  double resolution_m = 0.0;
  geometry::Pose2 T_map_grid;
};

/// `cells`: row by row from row 0, converted by cell_of.
OccupancyGrid occupancy_grid(const GridPlace& place, std::vector<std::int8_t> cells,
                             const Header& header);

}  // namespace topogeo::ros
