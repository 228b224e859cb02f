#include "pose_fusion.hpp"

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

TEST(OfOnePlace, SelectsTheMajority) {
  const UncertainPose here{{0.5, 1.8, -2.4}, Eigen::Matrix3d::Identity()};
  const UncertainPose beside{{0.6, 1.7, -2.3}, Eigen::Matrix3d::Identity()};
  const UncertainPose turned{{0.5, 1.8, -2.0}, Eigen::Matrix3d::Identity()};
  using Chosen = std::vector<bool>;
  EXPECT_EQ(of_one_place({turned, here, beside}, {true, true, true}, 1),
            (Chosen{false, true, true}));
  EXPECT_EQ(of_one_place({turned, here, beside}, {true, false, false}, 1),
            (Chosen{true, false, false}));
  EXPECT_EQ(of_one_place({here, turned}, {true, true}, 1), (Chosen{false, false}));
  EXPECT_EQ(of_one_place({here, beside}, {true, true}, 2), (Chosen{true, true}));
  EXPECT_EQ(of_one_place({here, beside}, {false, true}, 2), (Chosen{false, false}));
  EXPECT_TRUE(of_one_place({}, {}, 1).empty());
}

TEST(HeadingIsLost, WhenAQuarterTurnIsWithinTwoDeviations) {
  const auto known_to = [](double sigma_rad) {
    return UncertainPose{{}, Eigen::Vector3d(0.1, 0.1, sigma_rad * sigma_rad).asDiagonal()};
  };
  EXPECT_FALSE(heading_is_lost(known_to(0.7)));
  EXPECT_TRUE(heading_is_lost(known_to(0.8)));
}

}  // namespace
}  // namespace topogeo::localization
