#include "topogeo/navigation/outline_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/arc_sweep.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kNoMotion = 1e-6;      // m/s; slower is no motion
constexpr double kApproach_m = 0.004;   // an approach of this much is one, with rounding and noise
constexpr double kLeastStep_m = 0.003;  // least step

}  // namespace

double outline_speed(const geometry::Velocity& motion, const geometry::Footprint& footprint) {
  return std::fabs(motion.linear_m_per_s) +
         std::fabs(motion.angular_rad_per_s) * geometry::circumscribed_radius_m(footprint);
}

// No place of the body moves farther than `reach`, so a point stays free for its distance from it.
OutlineSweep sweep(const geometry::Velocity& motion, std::span<const Eigen::Vector2d> points_m,
                   const geometry::Footprint& footprint, double margin_m, double limit_m) {
  OutlineSweep swept{limit_m, limit_m, std::nullopt};
  const double speed = outline_speed(motion, footprint);
  if (speed < kNoMotion) return swept;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double begin_m = geometry::signed_distance_m(footprint, points_m[i]);
    const double touch_m = std::min(margin_m, begin_m - kApproach_m);
    double apart_m = begin_m;
    double reach_m = 0.0;
    while (true) {
      reach_m += std::max(apart_m - touch_m, kLeastStep_m);
      if (reach_m >= swept.reach_m) break;
      const geometry::Pose2 T_now_then = geometry::inverse(moved(motion, reach_m / speed));
      apart_m = geometry::signed_distance_m(footprint, T_now_then * points_m[i]);
      if (apart_m >= touch_m) continue;
      const bool at_once = begin_m <= margin_m;
      swept.reach_m = at_once ? 0.0 : std::max(0.0, reach_m - kLeastStep_m);
      swept.contact = i;
      break;
    }
  }
  swept.length_m = swept.reach_m * std::fabs(motion.linear_m_per_s) / speed;
  return swept;
}

}  // namespace topogeo::navigation
