#include "topogeo/scan/deskew.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::scan {
namespace {

/// Motion during a scan that is too small for the beams to show.
constexpr double kStill_m = 0.002;
constexpr double kStill_rad = 0.001;

Eigen::Vector2d direction_of(double angle_rad) {
  const auto [sine, cosine] = geometry::sincos(angle_rad);
  return {cosine, sine};
}

}  // namespace

double TimedRanges::farthest_s() const {
  const double last_beam_s = first_beam_s + beam_step_s * static_cast<double>(grid.beams - 1);
  return std::fabs(first_beam_s) > std::fabs(last_beam_s) ? first_beam_s : last_beam_s;
}

std::vector<float> deskewed(
    const TimedRanges& scan,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after) {
  const std::optional<geometry::Pose2> T_odom_start = T_odom_laser_after(0.0);
  const std::optional<geometry::Pose2> T_odom_end = T_odom_laser_after(scan.farthest_s());
  if (!T_odom_start || !T_odom_end) return scan.ranges_m;
  const geometry::Pose2 moved = geometry::between(*T_odom_start, *T_odom_end);
  if (moved.position_m().norm() <= kStill_m && std::fabs(moved.theta_rad) <= kStill_rad) {
    return scan.ranges_m;
  }
  const double middle_rad = scan.grid.angle_min_rad + 0.5 * scan.grid.angle_step_rad *
                                                          static_cast<double>(scan.grid.beams - 1);
  std::vector<Echo> echoes;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    if (range_m <= 0.0) continue;
    const double angle_rad =
        scan.grid.angle_min_rad + static_cast<double>(i) * scan.grid.angle_step_rad;
    const double after_s = scan.first_beam_s + static_cast<double>(i) * scan.beam_step_s;
    const auto T_odom_laser = T_odom_laser_after(after_s);
    Eigen::Vector2d point_m = range_m * direction_of(angle_rad);
    if (T_odom_laser) {
      const Eigen::Vector2d seen_m = geometry::between(*T_odom_start, *T_odom_laser) * point_m;
      if (seen_m.allFinite()) point_m = seen_m;  // a NaN angle could not be sorted
    }
    // Wrapped around the middle of the grid, so that each direction of a full turn has one place.
    const double seen_rad = geometry::atan2(point_m.y(), point_m.x());
    echoes.push_back({middle_rad + geometry::wrap_angle(seen_rad - middle_rad), point_m});
  }
  return on_grid(std::move(echoes), scan.grid);
}

}  // namespace topogeo::scan
