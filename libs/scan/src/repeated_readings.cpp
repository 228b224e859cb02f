#include "topogeo/scan/repeated_readings.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

bool RepeatedReadings::add(const std::vector<float>& ranges_m, const geometry::Pose2& T_odom_robot,
                           std::uint64_t odometry_epoch) {
  constexpr double kMoved_m = 0.01;
  constexpr double kMoved_rad = 0.005;
  const auto without = static_cast<std::size_t>(std::ranges::count(ranges_m, Scan::kNoReturn));
  if (ranges_m.size() - without < fewest_echoes_ || odometry_epoch != epoch_seen_ ||
      ranges_m != seen_m_) {
    seen_m_ = ranges_m;
    T_odom_seen_ = T_odom_robot;
    epoch_seen_ = odometry_epoch;
    return false;
  }
  const geometry::Pose2 moved = geometry::between(T_odom_seen_, T_odom_robot);
  return moved.position_m().norm() > kMoved_m || std::fabs(moved.theta_rad) > kMoved_rad;
}

}  // namespace topogeo::scan
