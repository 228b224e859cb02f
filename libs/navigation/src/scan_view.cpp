#include "scan_view.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::navigation {

ScanView::ScanView(const ScanPoints& scan) : T_laser_robot_(inverse(scan.T_robot_laser)) {
  beams_.reserve(scan.points_m.size());
  for (const Eigen::Vector2d& point_m : scan.points_m) {
    const Eigen::Vector2d seen_m = T_laser_robot_ * point_m;
    beams_.push_back({geometry::atan2(seen_m.y(), seen_m.x()), seen_m.norm()});
  }
  std::sort(beams_.begin(), beams_.end(),
            [](const Beam& a, const Beam& b) { return a.bearing_rad < b.bearing_rad; });
}

Sight ScanView::look(const Eigen::Vector2d& place_m, double radius_m) const {
  constexpr double kNoise_m = 0.08;
  const Eigen::Vector2d seen_m = T_laser_robot_ * place_m;
  const double range_m = seen_m.norm();
  if (range_m < radius_m) return Sight::kUnseen;
  const double bearing_rad = geometry::atan2(seen_m.y(), seen_m.x());
  const double half_rad = std::max(0.5 * radius_m / range_m, 0.006);
  const auto first =
      std::lower_bound(beams_.begin(), beams_.end(), bearing_rad - half_rad,
                       [](const Beam& beam, double bearing) { return beam.bearing_rad < bearing; });
  bool free = false;
  for (auto beam = first; beam != beams_.end() && beam->bearing_rad <= bearing_rad + half_rad;
       ++beam) {
    if (beam->range_m < range_m - radius_m - kNoise_m) return Sight::kUnseen;  // something before
    if (beam->range_m <= range_m + radius_m + kNoise_m) return Sight::kOccupied;
    free = true;
  }
  return free ? Sight::kFree : Sight::kUnseen;
}

}  // namespace topogeo::navigation
