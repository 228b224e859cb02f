#include "topogeo/simulation/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace topogeo::simulation {

World scene_at(const World& world, double way_m) {
  World scene{world.name, world.segments, world.circles, {}, {}, {}};
  for (const ChangingPart& part : world.changing) {
    const bool inside =
        std::any_of(part.present.begin(), part.present.end(), [way_m](const WayInterval& interval) {
          return way_m >= interval.from_m && way_m < interval.to_m;
        });
    if (inside == part.otherwise) continue;
    scene.segments.insert(scene.segments.end(), part.segments.begin(), part.segments.end());
    scene.circles.insert(scene.circles.end(), part.circles.begin(), part.circles.end());
  }
  return scene;
}

double clearance_m(const World& world, const Eigen::Vector2d& point_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment& segment : world.segments) {
    const Eigen::Vector2d along = segment.b_m - segment.a_m;
    const double length2 = along.squaredNorm();
    const double share =
        length2 > 0.0 ? std::clamp((point_m - segment.a_m).dot(along) / length2, 0.0, 1.0) : 0.0;
    nearest_m = std::min(nearest_m, (point_m - segment.a_m - share * along).norm());
  }
  for (const Circle& circle : world.circles) {
    const double distance_m = std::fabs((point_m - circle.center_m).norm() - circle.radius_m);
    nearest_m = std::min(nearest_m, distance_m);
  }
  return nearest_m;
}

}  // namespace topogeo::simulation
