// Errors of a map's stops against their true places.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::test {

/// Largest distance of a stop from its true place, m, when the first stop is aligned with its true
/// pose. `T_world_robot` returns the true pose of a stop.
inline double largest_error_m(
    const storage::MapDocument& map,
    const std::function<geometry::Pose2(const topomap::LocalMap&)>& T_world_robot) {
  using geometry::between;
  const auto& stops = map.trajectory.stops;
  double largest_m = 0.0;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const geometry::Pose2 T_true =
        between(T_world_robot(map.local_maps[0]), T_world_robot(map.local_maps[i]));
    const geometry::Pose2 T = between(stops[0].T_map_robot, stops[i].T_map_robot);
    largest_m = std::max(largest_m, between(T_true, T).position_m().norm());
  }
  return largest_m;
}

}  // namespace topogeo::test
