#include "topogeo/localization/tracking/pose_fusion.hpp"

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

TEST(Fused, IsTheWeightedMean) {
  UncertainPose a{{0.0, 0.0, 0.1}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()};
  UncertainPose b{{0.3, 0.0, 0.4}, Eigen::Vector3d(0.02, 0.01, 0.02).asDiagonal()};
  const UncertainPose mean = fused({a, b});
  EXPECT_NEAR(mean.T_a_b.x_m, 0.1, 1e-12);
  EXPECT_NEAR(mean.T_a_b.theta_rad, 0.2, 1e-12);
  EXPECT_NEAR(mean.covariance(0, 0), 0.02 / 3.0, 1e-12);
}

TEST(Fused, OneMeasurementIsItself) {
  const UncertainPose a{{1.0, 2.0, 3.0}, Eigen::Vector3d(0.01, 0.02, 0.03).asDiagonal()};
  EXPECT_EQ(fused({a}).T_a_b, a.T_a_b);
  EXPECT_EQ(fused({a}).covariance, a.covariance);
}

TEST(Fused, HeadingsMeetAcrossTheTurn) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal();
  const UncertainPose mean = fused({{{0.0, 0.0, 3.1}, covariance}, {{0.0, 0.0, -3.1}, covariance}});
  EXPECT_NEAR(std::fabs(mean.T_a_b.theta_rad), 3.14159265358979, 1e-9);
}

}  // namespace
}  // namespace topogeo::localization
