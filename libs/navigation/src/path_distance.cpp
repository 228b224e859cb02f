#include "path_distance.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::navigation {

double distance_m(std::span<const planning::PathSample> path, const Eigen::Vector2d& point_m) {
  double least_m = HUGE_VAL;
  for (const planning::PathSample& sample : path) {
    least_m = std::min(least_m, (sample.T_map_robot.position_m() - point_m).norm());
  }
  return least_m;
}

}  // namespace topogeo::navigation
