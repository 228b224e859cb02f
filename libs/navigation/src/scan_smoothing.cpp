#include "scan_smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace topogeo::navigation {

ScanPoints smoothed(const ScanPoints& scan, double most_m) {
  constexpr std::size_t kBeside = 3;      // beams on either side: a door post has more
  constexpr double kSameSurface_m = 0.1;  // noise of a PLS is less, a post stands out by more
  constexpr double kNeighbours = 0.05;    // chord between two beams, of the range
  ScanPoints result = scan;
  const std::size_t count = scan.points_m.size();
  const Eigen::Vector2d laser_m = scan.T_robot_laser.position_m();
  std::vector<double> ranges_m(count);
  for (std::size_t i = 0; i < count; ++i) ranges_m[i] = (scan.points_m[i] - laser_m).norm();
  for (std::size_t i = 0; i < count; ++i) {
    if (ranges_m[i] < 1e-6) continue;
    const Eigen::Vector2d direction = (scan.points_m[i] - laser_m) / ranges_m[i];
    double sum_m = 0.0;
    double seen = 0.0;
    const std::size_t begin = i < kBeside ? 0 : i - kBeside;
    for (std::size_t k = begin; k < std::min(count, i + kBeside + 1); ++k) {
      if (std::fabs(ranges_m[k] - ranges_m[i]) > kSameSurface_m || ranges_m[k] < 1e-6) continue;
      if (((scan.points_m[k] - laser_m) / ranges_m[k] - direction).norm() > kNeighbours) continue;
      sum_m += ranges_m[k];
      seen += 1.0;
    }
    const double shift_m = std::clamp(sum_m / seen - ranges_m[i], -most_m, most_m);
    result.points_m[i] += shift_m * direction;
  }
  return result;
}

}  // namespace topogeo::navigation
