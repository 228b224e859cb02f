#include "topogeo/simulation/drive.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace topogeo::simulation {
namespace {

const std::vector<Eigen::Vector2d> kTour = {{0, 0}, {6, 0}, {6, 4}, {4, 4}, {6, 4}, {6, 8}};

TEST(Drive, StartsAndEndsAtTheTourAndKeepsItsLimits) {
  const DriveOptions options;
  const auto poses = drive(kTour, options);
  EXPECT_EQ(poses.front().time_ns, 0);
  EXPECT_EQ(poses.front().T_world_robot, geometry::Pose2());
  EXPECT_LT((poses.back().T_world_robot.position_m() - kTour.back()).norm(), 0.06);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double dt_s = static_cast<double>(poses[i].time_ns - poses[i - 1].time_ns) * 1e-9;
    ASSERT_GT(dt_s, 0.0);
    const auto step = geometry::between(poses[i - 1].T_world_robot, poses[i].T_world_robot);
    ASSERT_LE(step.position_m().norm() / dt_s, options.speed_m_per_s + 1e-9);
    ASSERT_LE(std::fabs(step.theta_rad) / dt_s, options.turn_rad_per_s + 1e-9);
  }
}

TEST(Drive, PassesNearEveryWayPoint) {
  const DriveOptions options;
  const auto poses = drive(kTour, options);
  for (const Eigen::Vector2d& point_m : kTour) {
    double nearest_m = 1e9;
    for (const TimedPose& pose : poses) {
      nearest_m = std::min(nearest_m, (pose.T_world_robot.position_m() - point_m).norm());
    }
    EXPECT_LT(nearest_m, options.lookahead_m) << point_m.transpose();
  }
}

TEST(Drive, RefusesWhatCannotBeDriven) {
  EXPECT_THROW(drive({}, {}), std::invalid_argument);
  EXPECT_THROW(drive({{1, 1}}, {}), std::invalid_argument);
  EXPECT_THROW(drive({{1, 1}, {1, 1}}, {}), std::invalid_argument);
  EXPECT_THROW(drive(kTour, {.speed_m_per_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(drive(kTour, {.turn_rad_per_s = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(drive(kTour, {.lookahead_m = 100.0}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::simulation
