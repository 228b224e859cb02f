#include "snapping.hpp"

#include <algorithm>

namespace topogeo::planning {

std::optional<BranchPlace> nearest_place(const topomap::GlobalMap& map,
                                         const Eigen::Vector2d& point_m, double min_clearance_m) {
  std::optional<BranchPlace> best;
  for (std::size_t b = 0; b < map.branches.size(); ++b) {
    const auto& points = map.branches[b].points;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      // A segment counts as narrow as its narrower end: the two ends are a few centimetres apart.
      if (!map.branches[b].is_virtual &&
          std::min(points[i].clearance_m, points[i + 1].clearance_m) < min_clearance_m) {
        continue;
      }
      const Eigen::Vector2d along = points[i + 1].position_m - points[i].position_m;
      const double length2 = along.squaredNorm();
      const double t =
          length2 > 0.0
              ? std::clamp((point_m - points[i].position_m).dot(along) / length2, 0.0, 1.0)
              : 0.0;
      BranchPlace place;
      place.branch = b;
      place.segment = i;
      place.along = t;
      place.at.position_m = points[i].position_m + t * along;
      place.at.clearance_m =
          points[i].clearance_m + t * (points[i + 1].clearance_m - points[i].clearance_m);
      place.distance_m = (point_m - place.at.position_m).norm();
      if (!best || place.distance_m < best->distance_m) best = place;
    }
  }
  return best;
}

}  // namespace topogeo::planning
