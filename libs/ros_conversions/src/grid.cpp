#include "topogeo/ros_conversions/grid.hpp"

#include <utility>

#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros {

std::int8_t cell_of(std::uint8_t state) {
  constexpr std::uint8_t kStateFree = 0;
  constexpr std::uint8_t kStateOccupied = 1;
  if (state == kStateFree) return kFreeCell;
  return state == kStateOccupied ? kOccupiedCell : kUnknownCell;
}

OccupancyGrid occupancy_grid(const GridPlace& place, std::vector<std::int8_t> cells,
                             const Header& header) {
  OccupancyGrid grid;
  grid.header_(header);
  grid.info_().map_load_time_(header.stamp_());
  grid.info_().resolution_(static_cast<float>(place.resolution_m));
  grid.info_().width_(place.columns);
  grid.info_().height_(place.rows);
  grid.info_().origin_(pose_of(place.T_map_grid));
  grid.data_(std::move(cells));
  return grid;
}

}  // namespace topogeo::ros
