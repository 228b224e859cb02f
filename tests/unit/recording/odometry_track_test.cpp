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
  EXPECT_NEAR(*track.distance_s(23 * kTenth_ns), 0.3, 1e-9);
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

}  // namespace
}  // namespace topogeo::recording
