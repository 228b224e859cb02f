#include "topogeo/matching/odometry_model.hpp"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr OdometryNoise kSmallNoise{0.0004, 0.0004, 0.0001, 0.0004, 0.0005};

UncertainPose drive_straight(double distance_m, int steps, const OdometryNoise& noise) {
  UncertainPose pose;
  for (int i = 0; i < steps; ++i) pose = advance(pose, {distance_m / steps, 0.0, 0.0}, noise);
  return pose;
}

TEST(OdometryModelTest, HasTheModelOfTheSourceAsASpecialCase) {
  const double k11 = 0.01;
  const double k33 = 0.03;
  const OdometryNoise source{k11, 0.0, 0.0, 0.0, k33};
  // Eqs. 6.4 to 6.8 along the x axis, where the axes of 6.8 are those of the step.
  const std::vector<std::pair<double, double>> steps{{1.0, 0.0}, {2.0, 0.0}, {0.5, 0.4}};
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  UncertainPose found;
  for (const auto& [distance_m, turn_rad] : steps) {
    Eigen::Matrix3d j = Eigen::Matrix3d::Identity();
    j(1, 2) = distance_m;  // 6.7 at heading 0
    const Eigen::Vector3d q(k11 * distance_m, 0.0, k33 * turn_rad);
    expected = (j * expected * j.transpose() + Eigen::Matrix3d(q.asDiagonal())).eval();
    found = advance(found, {distance_m, 0.0, turn_rad}, source);
  }
  EXPECT_TRUE(found.covariance.isApprox(expected, 1e-12)) << found.covariance;
}

TEST(OdometryModelTest, OneStepHasTheVariancesOfItsWayAndTurn) {
  const OdometryNoise noise{0.01, 0.02, 0.03, 0.04, 0.05};
  const Eigen::Matrix3d straight = advance({}, {2.0, 0.0, 0.0}, noise).covariance;
  EXPECT_DOUBLE_EQ(straight(0, 0), 0.02);
  EXPECT_DOUBLE_EQ(straight(1, 1), 0.06 + 0.08 * 4.0 / 3.0);  // lateral, and the heading's wander
  EXPECT_DOUBLE_EQ(straight(1, 2), 0.08);
  EXPECT_DOUBLE_EQ(straight(2, 1), 0.08);
  EXPECT_DOUBLE_EQ(straight(2, 2), 0.08);
  const Eigen::Matrix3d turned = advance({}, {0.0, 0.0, -0.5}, noise).covariance;
  EXPECT_DOUBLE_EQ(turned(0, 0), 0.01);
  EXPECT_DOUBLE_EQ(turned(1, 1), 0.01);
  EXPECT_DOUBLE_EQ(turned(2, 2), 0.025);
}

TEST(OdometryModelTest, StandingStillAddsNothing) {
  const UncertainPose before = drive_straight(1.0, 4, {});
  const UncertainPose after = advance(before, {}, {});
  EXPECT_EQ(after.T_a_b, before.T_a_b);
  EXPECT_TRUE(after.covariance.isApprox(before.covariance, 1e-12));
}

TEST(OdometryModelTest, EveryVarianceGrowsOnAStraightWay) {
  UncertainPose pose;
  for (int i = 0; i < 30; ++i) {
    const UncertainPose next = advance(pose, {0.2, 0.0, 0.0}, {});
    for (int k = 0; k < 3; ++k) EXPECT_GT(next.covariance(k, k), pose.covariance(k, k));
    pose = next;
  }
}

TEST(OdometryModelTest, DoesNotDependOnHowAStraightWayIsCut) {
  const OdometryNoise noise;
  const double distance_m = 5.0;
  const Eigen::Matrix3d fine = drive_straight(distance_m, 1000, noise).covariance;
  for (const int steps : {1, 3, 20, 200}) {
    const Eigen::Matrix3d cut = drive_straight(distance_m, steps, noise).covariance;
    EXPECT_TRUE(cut.isApprox(fine, 1e-9)) << steps << "\n" << cut;
  }
  // The limit: lateral noise, and heading noise q per metre, which adds q L^3 / 3 laterally.
  const double limit_m2 = noise.lateral_m2_per_m * distance_m +
                          noise.heading_rad2_per_m * distance_m * distance_m * distance_m / 3.0;
  EXPECT_NEAR(fine(1, 1) / limit_m2, 1.0, 1e-9);
}

TEST(OdometryModelTest, HeadingNoiseOfAStraightWayIsPerMetre) {
  OdometryNoise noise;
  noise.heading_rad2_per_m = 0.01;
  EXPECT_NEAR(drive_straight(3.0, 10, noise).covariance(2, 2), 0.03, 1e-12);
  noise.heading_rad2_per_m = 0.0;
  EXPECT_EQ(drive_straight(3.0, 10, noise).covariance(2, 2), 0.0);
}

TEST(OdometryModelTest, AgreesWithRandomDrives) {
  const std::vector<Pose2> steps(12, Pose2{0.3, 0.02, 0.08});
  UncertainPose expected;
  for (const Pose2& step : steps) expected = advance(expected, step, kSmallNoise);

  support::Random random(5);
  constexpr int kDrives = 6000;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int drive = 0; drive < kDrives; ++drive) {
    Pose2 pose;
    for (const Pose2& step : steps) {
      const Eigen::Matrix3d root = advance({}, step, kSmallNoise).covariance.llt().matrixL();
      const Eigen::Vector3d noise =
          root * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      pose = pose * Pose2{step.x_m + noise.x(), step.y_m + noise.y(), step.theta_rad + noise.z()};
    }
    const Eigen::Vector3d error(pose.x_m - expected.T_a_b.x_m, pose.y_m - expected.T_a_b.y_m,
                                geometry::wrap_angle(pose.theta_rad - expected.T_a_b.theta_rad));
    sum += error * error.transpose() / kDrives;
  }
  // Whitened by the expected covariance, the sample covariance must be the identity.
  const Eigen::Matrix3d root = expected.covariance.llt().matrixL();
  const Eigen::Matrix3d whitened =
      root.triangularView<Eigen::Lower>().solve(sum) * root.inverse().transpose();
  EXPECT_LT((whitened - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.08) << whitened;
}

TEST(OdometryModelTest, BetweenStopsGoesThroughTheScansBetween) {
  const Pose2 T_odom_previous{2.0, -1.0, 0.5};
  const std::vector<Pose2> steps{{0.3, 0.0, 0.1}, {0.3, 0.0, -0.1}, {0.2, 0.0, 0.4}};
  topomap::LocalMap map;
  UncertainPose expected;
  Pose2 T_odom = T_odom_previous;
  for (const Pose2& step : steps) {
    expected = advance(expected, step, {});
    T_odom = T_odom * step;
    map.track.push_back({0, 0, T_odom, {}, true});
  }
  map.T_odom_robot = map.track.back().T_odom_robot;
  map.track.pop_back();

  const UncertainPose found = odometry_between_stops(T_odom_previous, map, {});
  EXPECT_NEAR(found.T_a_b.x_m, expected.T_a_b.x_m, 1e-12);
  EXPECT_NEAR(found.T_a_b.y_m, expected.T_a_b.y_m, 1e-12);
  EXPECT_NEAR(found.T_a_b.theta_rad, 0.4, 1e-12);
  EXPECT_TRUE(found.covariance.isApprox(expected.covariance, 1e-9));
  // The heading's motion back and forth counts, which one step from stop to stop would miss.
  map.track.clear();
  EXPECT_GT(found.covariance(2, 2),
            odometry_between_stops(T_odom_previous, map, {}).covariance(2, 2) + 0.005);
}

TEST(SearchSpaceTest, IsTheRectangleRoundTheErrorEllipse) {
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.03, 0.0, 0.03, 0.09, 0.0, 0.0, 0.0, 0.01;
  const Eigen::Vector3d half = search_half_width(covariance, 0.95, 3.0);
  EXPECT_NEAR(half.x(), std::sqrt(5.991) * 0.2, 1e-4);
  EXPECT_NEAR(half.y(), std::sqrt(5.991) * 0.3, 1e-4);
  EXPECT_NEAR(half.z(), 0.3, 1e-12);

  // The extremes of points on the ellipse itself.
  const Eigen::Matrix2d root = covariance.topLeftCorner<2, 2>().llt().matrixL();
  Eigen::Vector2d largest = Eigen::Vector2d::Zero();
  for (int i = 0; i < 3600; ++i) {
    const double angle = i * 2.0 * std::numbers::pi / 3600.0;
    const Eigen::Vector2d p =
        std::sqrt(ellipse_k2(0.95)) * (root * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    largest = largest.cwiseMax(p);
  }
  EXPECT_NEAR(half.x(), largest.x(), 1e-5);
  EXPECT_NEAR(half.y(), largest.y(), 1e-5);
}

}  // namespace
}  // namespace topogeo::localization
