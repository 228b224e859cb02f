#include "history/comparison.hpp"

#include <cstddef>
#include <utility>

#include "history/map_difference.hpp"

namespace topogeo::web {
namespace {

/// The grid of a map; the grid of its drawing when the map has no scans.
planning::OccupancyGrid grid_of_map(const storage::MapDocument& map,
                                    const planning::ScanGridConfig& config) {
  if (map.local_maps.empty() && map.drawing.grid) return *map.drawing.grid;
  return planning::grid_from_scans(map.local_maps, map.trajectory.stops, config);
}

Json stored_version(const storage::MapDocument& map, const std::string& name) {
  return {{"name", name},
          {"stops", map.trajectory.stops.size()},
          {"version", std::to_string(map.trajectory.version)}};
}

}  // namespace

Comparison compared(const NamedVersion& before, const NamedVersion& after,
                    const planning::ScanGridConfig& config) {
  const MapDifference made =
      difference(grid_of_map(*before.map, config), grid_of_map(*after.map, config));
  Json json = {{"before", stored_version(*before.map, before.name)},
               {"after", stored_version(*after.map, after.name)},
               {"columns", made.frame.columns},
               {"rows", made.frame.rows},
               {"resolution_m", made.frame.resolution_m}};
  set_pose(json, made.frame.T_map_grid);
  const auto area = [&](CellChange change) {
    return rounded(made.areas_m2.at(static_cast<std::size_t>(change)));
  };
  json["gone_m2"] = area(CellChange::kGone);
  json["new_m2"] = area(CellChange::kNew);
  json["seen_m2"] = area(CellChange::kSeen);
  json["lost_m2"] = area(CellChange::kLost);
  return {std::move(json), difference_png(made)};
}

}  // namespace topogeo::web
