#include "topogeo/recording/odometry_track.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::recording {
namespace {

constexpr std::int64_t kTenth_ns = 100'000'000;

TEST(OdometryTrack, InterpolatesAndTakesTheShorterWayRound) {
  OdometryTrack track;
  track.add(0, {0.0, 0.0, 3.0});
  track.add(kTenth_ns, {1.0, 2.0, -3.0});
  const auto pose = track.at(kTenth_ns / 2);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 0.5, 1e-12);
  EXPECT_NEAR(pose->y_m, 1.0, 1e-12);
  EXPECT_NEAR(std::fabs(pose->theta_rad), std::numbers::pi, 1e-12);
  EXPECT_EQ(track.at(kTenth_ns), (geometry::Pose2{1.0, 2.0, -3.0}));
}

TEST(OdometryTrack, HasNoPoseFarFromAll) {
  OdometryTrack track;
  EXPECT_FALSE(track.at(0));
  track.add(0, {});
  track.add(20 * kTenth_ns, {1.0, 0.0, 0.0});
  EXPECT_TRUE(track.at(20 * kTenth_ns + kTenth_ns / 2));  // held
  EXPECT_FALSE(track.at(22 * kTenth_ns));
  EXPECT_FALSE(track.at(10 * kTenth_ns));  // the robot has moved, two seconds without odometry
  EXPECT_EQ(track.gap_at(23 * kTenth_ns).before_ns, 20 * kTenth_ns);
  EXPECT_FALSE(track.gap_at(23 * kTenth_ns).after_ns);
  EXPECT_EQ(track.gap_at(10 * kTenth_ns).step_m, 1.0);
  track.add(40 * kTenth_ns, {1.0, 0.0, 0.0});
  EXPECT_TRUE(track.at(30 * kTenth_ns));  // it stood
}

TEST(OdometryTrack, SortsWhatComesLate) {
  OdometryTrack track;
  track.add(2 * kTenth_ns, {2.0, 0.0, 0.0});
  track.add(kTenth_ns, {1.0, 0.0, 0.0});
  track.add(0, {0.0, 0.0, 0.0});
  EXPECT_NEAR(track.at(kTenth_ns / 2)->x_m, 0.5, 1e-12);
  EXPECT_NEAR(track.at(kTenth_ns * 3 / 2)->x_m, 1.5, 1e-12);
}

// A pose each 1.6 s: as long as the robot moves little from one to the next.
TEST(OdometryTrack, InterpolatesSlowOdometryAsFarAsTheMotionAllows) {
  OdometryTrack track;
  const std::int64_t period_ns = 16 * kTenth_ns;
  double x_m = 0.0;
  double theta_rad = 0.0;
  for (int i = 0; i < 20; ++i) {
    track.add(i * period_ns, {x_m, 0.0, theta_rad});
    if (i < 10) x_m += 1.9;
    if (i == 12) x_m += 2.1;
    if (i == 14) theta_rad += 1.7;
    if (i == 16) theta_rad += 1.5;
  }
  EXPECT_FALSE(track.at(period_ns / 2));  // before the rate is known
  track.finish();
  EXPECT_EQ(track.period_ns(), period_ns);
  EXPECT_NEAR(track.at(period_ns / 2)->x_m, 0.95, 1e-12);
  EXPECT_FALSE(track.at(12 * period_ns + period_ns / 2));
  EXPECT_FALSE(track.at(14 * period_ns + period_ns / 2));
  EXPECT_NEAR(track.at(16 * period_ns + period_ns / 2)->theta_rad, 2.45, 1e-12);
}

TEST(OdometryTrack, DoesNotBridgeAGapOfFastOdometry) {
  OdometryTrack track;
  for (int i = 0; i < 40; ++i) {
    if (i < 15 || i > 30) track.add(i * kTenth_ns, {0.01 * i, 0.0, 0.0});
  }
  track.finish();
  EXPECT_FALSE(track.at(20 * kTenth_ns + kTenth_ns / 2));
  EXPECT_NEAR(track.gap_at(20 * kTenth_ns).step_m, 0.17, 1e-9);
}

}  // namespace
}  // namespace topogeo::recording
