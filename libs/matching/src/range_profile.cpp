#include "topogeo/matching/range_profile.hpp"

#include <numbers>
#include <utility>

namespace topogeo::localization {

const RangeProfile::BinOfCell& RangeProfile::bin_of_cell() {
  static const BinOfCell kBinOfCell = [] {
    BinOfCell bins{};
    for (int i = 0; i < 4 * kCellsPerQuadrant; ++i) {
      // The inverse of bin_of(), in the middle of the cell.
      const double in_quadrant = (i % kCellsPerQuadrant + 0.5) / kCellsPerQuadrant;
      double x = 1.0 - in_quadrant;
      double y = in_quadrant;
      for (int quadrant = i / kCellsPerQuadrant; quadrant > 0; --quadrant) {
        x = std::exchange(y, x);
        x = -x;
      }
      const double turn = geometry::atan2(y, x) / (2.0 * std::numbers::pi);
      bins.at(static_cast<std::size_t>(i)) =
          static_cast<std::int16_t>(static_cast<int>((turn + 0.5) * kBins) % kBins);
    }
    return bins;
  }();
  return kBinOfCell;
}

RangeProfile::RangeProfile(std::span<const topomap::ScanPoint> points,
                           const geometry::Pose2& T_robot_laser)
    : laser_m_(T_robot_laser.position_m()),
      T_laser_robot_(geometry::inverse(T_robot_laser)),
      rotation_(geometry::sincos(T_laser_robot_.theta_rad)),
      ranges_(kBins) {
  std::vector<float> range_m(kBins, 0.0F);
  const auto put = [&](int bin, double range) {
    float& cell = range_m[static_cast<std::size_t>(bin)];
    if (cell == 0.0F || range < cell) cell = static_cast<float>(range);
  };
  int last_bin = -1;
  double last_range_m = 0.0;
  for (const topomap::ScanPoint& point : points) {
    const Eigen::Vector2d p = in_laser_frame({point.x_m, point.y_m});
    const double range = std::sqrt(p.squaredNorm());
    const int bin = bin_of(p);
    put(bin, range);
    // A coarser laser leaves bins between two beams; gaps of up to two degrees get the nearer
    // reading.
    if (last_bin >= 0 && bin > last_bin + 1 && bin <= last_bin + 4) {
      for (int k = last_bin + 1; k < bin; ++k) put(k, std::min(range, last_range_m));
    }
    last_bin = bin;
    last_range_m = range;
  }
  for (int k = 0; k < kBins; ++k) {
    Range& seen = ranges_[static_cast<std::size_t>(k)];
    for (int d = -1; d <= 1; ++d) {
      const float range = range_m[static_cast<std::size_t>((k + d + kBins) % kBins)];
      if (range == 0.0F) continue;
      seen.near_m = seen.near_m == 0.0F ? range : std::min(seen.near_m, range);
      seen.far_m = std::max(seen.far_m, range);
    }
  }
}

}  // namespace topogeo::localization
