#include "pose_keeper.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

TEST(PoseKeeper, CarriesAnOldFixOnByOdometry) {
  PoseKeeper keeper{PoseKeeperConfig{}};
  keeper.add(OdometrySample{kSecond_ns, {0.0, 0.0, 0.0}});
  keeper.add(OdometrySample{2 * kSecond_ns, {1.0, 0.0, 0.0}});
  PoseFix fix;
  fix.stamp_ns = kSecond_ns + kSecond_ns / 2;  // odometry was at 0.5 m
  fix.T_map_robot = {10.0, 5.0, 0.5 * std::numbers::pi};
  fix.tracking = true;
  keeper.add(fix);
  const auto pose = keeper.good_pose(2 * kSecond_ns);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 10.0, 1e-9);
  EXPECT_NEAR(pose->y_m, 5.5, 1e-9);
  // A fix newer than all odometry waits for odometry.
  fix.stamp_ns = 3 * kSecond_ns;
  fix.T_map_robot = {0.0, 0.0, 0.0};
  keeper.add(fix);
  EXPECT_NEAR(keeper.good_pose(2 * kSecond_ns)->y_m, 5.5, 1e-9);
  keeper.add(OdometrySample{3 * kSecond_ns, {2.0, 0.0, 0.0}});
  EXPECT_NEAR(keeper.good_pose(3 * kSecond_ns)->x_m, 0.0, 1e-9);
  EXPECT_NEAR(keeper.take_jump_m(), std::hypot(10.0, 6.5), 1e-9);
}

class PoseKeeperInCorridor : public testing::Test {
 protected:
  /// Drives a metre a second; each fix has these deviations along and across the corridor, which
  /// runs at 30 degrees.
  enum class Fix : std::uint8_t { kTracking, kPlaceKnown, kInDoubt };

  PoseKeeperInCorridor() { drive(Fix::kTracking, 0.1, 0.1); }

  void drive(Fix kind, double along_m, double across_m) {
    PoseFix fix;
    fix.located = true;
    fix.tracking = kind == Fix::kTracking;
    fix.place_known = kind == Fix::kPlaceKnown;
    now_ns_ += kSecond_ns;
    const double x_m = 1e-9 * static_cast<double>(now_ns_);
    keeper_.add(OdometrySample{now_ns_, {x_m, 0.0, 0.0}});
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(std::numbers::pi / 6.0).toRotationMatrix();
    fix.stamp_ns = now_ns_;
    fix.covariance.topLeftCorner<2, 2>() =
        turn * Eigen::Vector2d(along_m * along_m, across_m * across_m).asDiagonal() *
        turn.transpose();
    keeper_.add(fix);
  }
  bool may_drive() { return keeper_.good_pose(now_ns_).has_value(); }

  PoseKeeper keeper_{PoseKeeperConfig{}};
  std::int64_t now_ns_ = 0;
};

TEST_F(PoseKeeperInCorridor, DrivesOnWhereOnlyThePositionAlongItIsUncertain) {
  for (int i = 0; i < 10; ++i) drive(Fix::kPlaceKnown, 1.9, 0.4);
  EXPECT_TRUE(may_drive());
  drive(Fix::kPlaceKnown, 2.1, 0.1);
  EXPECT_FALSE(may_drive());
  EXPECT_NE(keeper_.why_not(now_ns_).find("2.10 m one way and 0.10 m the other"), std::string::npos)
      << keeper_.why_not(now_ns_);
  drive(Fix::kPlaceKnown, 0.6, 0.6);
  EXPECT_FALSE(may_drive());
}

TEST_F(PoseKeeperInCorridor, StopsAfterThreeMetresWhereThePlaceIsInDoubt) {
  for (int i = 0; i < 3; ++i) drive(Fix::kInDoubt, 0.3, 0.1);
  EXPECT_TRUE(may_drive());
  drive(Fix::kInDoubt, 0.3, 0.1);
  EXPECT_FALSE(may_drive());
}

}  // namespace
}  // namespace topogeo::navigation
