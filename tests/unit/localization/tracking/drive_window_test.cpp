#include "drive_window.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// A drive across the room, a stop every half metre.
class DriveWindowTest : public ::testing::Test {
 protected:
  DriveStep stop(const Pose2& truth, const std::optional<UncertainPose>& odometry) {
    auto map =
        std::make_shared<topomap::LocalMap>(test::map_at(test::world("room"), truth, next_++));
    map->T_previous_robot = odometry ? odometry->T_a_b : Pose2{};
    requests_.add_map(map);
    auto view = std::make_shared<const StopView>(
        view_of(extract_scan_features(map->points, map->T_robot_laser)));
    return window_.add(map, view, odometry);
  }
  static UncertainPose odometry(const Pose2& T) {
    return {T, Eigen::Vector3d(0.04, 0.04, 0.04).asDiagonal()};
  }

  InProcessPool pool_;
  LocalizerConfig config_;
  MatchRequests requests_{config_, pool_};
  DriveWindow window_{requests_};
  std::uint32_t next_ = 0;
};

TEST_F(DriveWindowTest, AStepIsAsMatchedAndNotAsOdometryHasIt) {
  EXPECT_FALSE(stop({1.0, 1.0, 0.0}, std::nullopt).matched);
  const DriveStep step = stop({1.5, 1.0, 0.1}, odometry({0.3, 0.1, -0.1}));
  EXPECT_TRUE(step.matched);
  EXPECT_NEAR(step.T_before_now.T_a_b.x_m, 0.5, 0.04);
  EXPECT_NEAR(step.T_before_now.T_a_b.y_m, 0.0, 0.04);
  EXPECT_NEAR(step.T_before_now.T_a_b.theta_rad, 0.1, 0.02);
  EXPECT_LT(step.T_before_now.covariance(2, 2), 0.002);
  EXPECT_NEAR(step.distance_m, 0.5, 0.04);
}

TEST_F(DriveWindowTest, WhereNothingMatchesOdometryStands) {
  stop({1.0, 1.0, 0.0}, std::nullopt);
  auto blind = std::make_shared<topomap::LocalMap>();
  blind->robot_id = "robot";
  blind->id = next_++;
  requests_.add_map(blind);
  const DriveStep step =
      window_.add(blind, std::make_shared<const StopView>(), odometry({0.4, 0.0, 0.2}));
  EXPECT_FALSE(step.matched);
  EXPECT_EQ(step.T_before_now.T_a_b, (Pose2{0.4, 0.0, 0.2}));
  EXPECT_GT(step.T_before_now.covariance(2, 2), 0.002);
}

TEST_F(DriveWindowTest, AFirstStopMayFollowAnother) {
  const DriveStep step = stop({1.0, 1.0, 0.0}, odometry({0.4, 0.0, 0.2}));
  EXPECT_FALSE(step.matched);
  EXPECT_EQ(step.T_before_now.T_a_b, (Pose2{0.4, 0.0, 0.2}));
}

TEST_F(DriveWindowTest, AGapForgetsWhatWasBefore) {
  stop({1.0, 1.0, 0.0}, std::nullopt);
  stop({1.5, 1.0, 0.0}, odometry({0.5, 0.0, 0.0}));
  EXPECT_NEAR(window_.length_m(), 0.5, 0.04);
  stop({1.0, 1.0, 0.0}, std::nullopt);
  EXPECT_EQ(window_.length_m(), 0.0);
}

// Seen from two places, in the frame of the second: the same walls.
TEST_F(DriveWindowTest, WhatWasSeenFromSeveralStopsLiesOnEachOther) {
  stop({1.0, 1.0, 0.0}, std::nullopt);
  const std::size_t alone = window_.seen(5.0).size();
  stop({1.5, 1.0, 0.3}, odometry({0.5, 0.0, 0.3}));
  const std::vector<SurfacePoint> seen = window_.seen(5.0);
  ASSERT_GT(seen.size(), alone);
  std::size_t near = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = 0; j < seen.size(); ++j) {
      if (i == j || (seen[i].position_m - seen[j].position_m).norm() > 0.25) continue;
      ++near;
      break;
    }
  }
  EXPECT_GT(static_cast<double>(near), 0.9 * static_cast<double>(seen.size()));
  EXPECT_LT(window_.seen(0.1).size(), seen.size());
}

}  // namespace
}  // namespace topogeo::localization
