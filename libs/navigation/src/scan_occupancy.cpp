#include "scan_occupancy.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::navigation {

ScanOccupancy::ScanOccupancy(const ScanPoints& scan) : T_laser_robot_(inverse(scan.T_robot_laser)) {
  beams_.reserve(scan.points_m.size());
  for (const Eigen::Vector2d& point_m : scan.points_m) {
    const Eigen::Vector2d seen_m = T_laser_robot_ * point_m;
    beams_.push_back({geometry::atan2(seen_m.y(), seen_m.x()), seen_m.norm(), seen_m});
  }
  std::sort(beams_.begin(), beams_.end(),
            [](const Beam& a, const Beam& b) { return a.bearing_rad < b.bearing_rad; });
}

Occupancy ScanOccupancy::at(const Eigen::Vector2d& place_m, double radius_m) const {
  constexpr double kNoise_m = 0.08;     // of a PLS and of the pose
  constexpr double kLeast_rad = 0.006;  // width of the gap between two beams
  const Eigen::Vector2d seen_m = T_laser_robot_ * place_m;
  const double range_m = seen_m.norm();
  const double around_m = radius_m + kNoise_m;
  if (range_m < 2.0 * around_m) return Occupancy::kUnseen;
  const double bearing_rad = geometry::atan2(seen_m.y(), seen_m.x());
  const double wide_rad = std::max(around_m / range_m, kLeast_rad);
  const double narrow_rad = std::max(0.5 * radius_m / range_m, kLeast_rad);
  const auto first =
      std::lower_bound(beams_.begin(), beams_.end(), bearing_rad - wide_rad,
                       [](const Beam& beam, double bearing) { return beam.bearing_rad < bearing; });
  bool free = false;
  bool hidden = false;
  for (auto beam = first; beam != beams_.end() && beam->bearing_rad <= bearing_rad + wide_rad;
       ++beam) {
    // A surface at a small angle may have its points before and behind the place.
    if ((beam->end_m - seen_m).squaredNorm() <= around_m * around_m) return Occupancy::kOccupied;
    if (std::fabs(beam->bearing_rad - bearing_rad) > narrow_rad) continue;
    if (beam->range_m < range_m) {
      hidden = true;
    } else {
      free = true;
    }
  }
  return free && !hidden ? Occupancy::kFree : Occupancy::kUnseen;
}

}  // namespace topogeo::navigation
