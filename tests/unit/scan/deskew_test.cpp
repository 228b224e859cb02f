#include "topogeo/scan/deskew.hpp"

#include <gtest/gtest.h>

namespace topogeo::scan {
namespace {

using geometry::Pose2;

/// Five beams ahead, half a radian apart, 0.1 s after each other.
TimedRanges five_beams(double first_beam_s, double beam_step_s) {
  return {{-1.0, 0.5, 5}, {2.0F, 2.0F, 2.0F, 2.0F, 2.0F}, first_beam_s, beam_step_s};
}

TEST(DeskewTest, TheFarthestBeamIsTheFirstOrTheLast) {
  EXPECT_DOUBLE_EQ(five_beams(0.0, 0.1).farthest_s(), 0.4);
  EXPECT_DOUBLE_EQ(five_beams(0.4, -0.1).farthest_s(), 0.4);
  EXPECT_DOUBLE_EQ(five_beams(-0.3, 0.1).farthest_s(), -0.3);
  EXPECT_DOUBLE_EQ(five_beams(0.0, 0.0).farthest_s(), 0.0);
}

TEST(DeskewTest, ALaserThatDrivesAheadSeesTheWallAheadFartherFromTheStamp) {
  const std::vector<float> ranges_m = deskewed(five_beams(0.0, 0.1), [](double after_s) {
    return Pose2{after_s, 0.0, 0.0};
  });
  EXPECT_NEAR(ranges_m[2], 2.2F, 0.01F);  // 1 m/s over 0.2 s
}

TEST(DeskewTest, NothingChangesWithoutMotionOrPoses) {
  const TimedRanges scan = five_beams(0.0, 0.1);
  EXPECT_EQ(deskewed(scan, [](double) { return Pose2{3.0, 1.0, 0.5}; }), scan.ranges_m);
  EXPECT_EQ(deskewed(scan, [](double) { return std::nullopt; }), scan.ranges_m);
}

}  // namespace
}  // namespace topogeo::scan
