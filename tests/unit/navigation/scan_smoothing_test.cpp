#include "scan_smoothing.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

TEST(ScanSmoothing, TakesNoiseOffAWallAndLeavesLonePoints) {
  support::Random random(5);
  ScanPoints scan;
  for (int i = -90; i <= 90; ++i) {
    const double bearing_rad = 0.005 * i;
    const double range_m = 2.0 / std::cos(bearing_rad) + 0.02 * random.normal();
    scan.points_m.emplace_back(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
  }
  scan.points_m.emplace_back(0.0, 1.0);
  const ScanPoints result = smoothed(scan, 0.02);
  double before_m = 0.0;
  double after_m = 0.0;
  for (std::size_t i = 0; i + 1 < scan.points_m.size(); ++i) {
    before_m += std::fabs(scan.points_m[i].x() - 2.0);
    after_m += std::fabs(result.points_m[i].x() - 2.0);
    EXPECT_LE((scan.points_m[i] - result.points_m[i]).norm(), 0.02 + 1e-9);
  }
  EXPECT_LT(after_m, 0.7 * before_m);
  EXPECT_EQ(result.points_m.back(), scan.points_m.back());
}

}  // namespace
}  // namespace topogeo::navigation
