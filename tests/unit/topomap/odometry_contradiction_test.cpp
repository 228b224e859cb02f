#include "topogeo/topomap/odometry_contradiction.hpp"

#include <gtest/gtest.h>

namespace topogeo::topomap {
namespace {

using geometry::Pose2;

constexpr Pose2 kOdomPrevious{3.0, 4.0, 1.0};

/// A stop whose odometry has moved by `odometry` and whose scans by `scans`.
LocalMap step(const Pose2& odometry, const Pose2& scans) {
  LocalMap map;
  map.T_odom_robot = kOdomPrevious * odometry;
  map.T_previous_robot = scans;
  map.track.push_back({0, 0, map.T_odom_robot, scans, true});
  return map;
}

TEST(OdometryContradiction, NoneWithinTheErrorsOfWheels) {
  EXPECT_FALSE(odometry_contradiction(kOdomPrevious, step({1.0, 0.0, 0.1}, {1.0, 0.0, 0.1})));
  EXPECT_FALSE(odometry_contradiction(kOdomPrevious, step({1.3, 0.0, 0.0}, {0.9, 0.3, 0.4})));
}

TEST(OdometryContradiction, OfWheelsThatSpinWhileTheRobotStands) {
  const auto found = odometry_contradiction(kOdomPrevious, step({1.5, 0.0, 0.0}, {0.02, 0.0, 0.0}));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->odometry_m, 1.5, 1e-9);
  EXPECT_NEAR(found->scans_m, 0.02, 1e-9);
}

TEST(OdometryContradiction, OfARobotThatIsCarriedWhileItsWheelsStand) {
  const auto found = odometry_contradiction(kOdomPrevious, step({}, {0.6, 0.8, 0.0}));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->odometry_m, 0.0, 1e-9);
  EXPECT_NEAR(found->scans_m, 1.0, 1e-9);
}

TEST(OdometryContradiction, OfATurnThatOnlyTheWheelsMake) {
  const auto found = odometry_contradiction(kOdomPrevious, step({0.0, 0.0, 0.8}, {}));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->turn_rad, -0.8, 1e-9);
}

TEST(OdometryContradiction, OfWheelsThatStandIsSeenSooner) {
  EXPECT_FALSE(odometry_contradiction(kOdomPrevious, step({}, {0.05, 0.0, 0.05})));
  EXPECT_TRUE(odometry_contradiction(kOdomPrevious, step({}, {0.15, 0.0, 0.0})));
  EXPECT_TRUE(odometry_contradiction(kOdomPrevious, step({}, {0.0, 0.0, 0.35})));
}

TEST(OdometryContradiction, NeedsScansThatMatch) {
  LocalMap map = step({1.5, 0.0, 0.0}, {});
  map.track.back().matched = false;
  EXPECT_FALSE(odometry_contradiction(kOdomPrevious, map));
  map.track.clear();
  EXPECT_FALSE(odometry_contradiction(kOdomPrevious, map));
}

}  // namespace
}  // namespace topogeo::topomap
