// The steps of the backward correction from a pose to the previous one: matches (eqs. 7.22 to 7.24
// of the thesis), odometry, the grid.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "backward_problems.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::covariance_of;

BackwardProblem five_poses() {
  BackwardProblem problem;
  problem.first_id = 10;
  problem.poses.resize(5);
  for (std::uint32_t k = 1; k < 5; ++k) {
    problem.poses[k].T_first_this = {{1.0 * k, 0.0, 0.0}, covariance_of(0.1, 0.1)};
    problem.poses[k].T_previous_this = {{1.0, 0.1, 0.2}, covariance_of(0.2, 0.05)};
    problem.poses[k].overlaps = {10 + k - 1};
  }
  return problem;
}

TEST(StepOptions, AreTheStoredSolutionsOfBothMaps) {
  SolutionStore solutions;
  solutions.put(12, 13,
                {{{1.0, 0.0, 0.0}, covariance_of(0.1, 0.1), 0.5},
                 {{1.2, 0.0, 0.0}, covariance_of(0.1, 0.1), 0.9}});
  solutions.put(11, 13, {{{5.0, 0.0, 0.0}, covariance_of(0.1, 0.1), 1.0}});
  const auto options = step_options(five_poses(), solutions, {}, 3);
  ASSERT_EQ(options.size(), 2U);
  EXPECT_EQ(options[0].kind, StepKind::kMatched);
  EXPECT_EQ(options[0].T_previous_this, (Pose2{1.2, 0.0, 0.0}));
  EXPECT_EQ(options[0].fitness, 0.9);
}

TEST(StepOptions, GoThroughAnIntermediateMap) {
  // Seen from map 11, map 12 is 2 m to the left and map 13 is 3 m ahead, turned to the left.
  SolutionStore solutions;
  solutions.put(11, 13, {{{3.0, 0.0, std::numbers::pi / 2}, covariance_of(0.1, 0.02), 0.8}});
  solutions.put(11, 12, {{{0.0, 2.0, 0.0}, covariance_of(0.2, 0.02), 0.6}});
  const auto options = step_options(five_poses(), solutions, {}, 3);
  ASSERT_EQ(options.size(), 1U);
  EXPECT_EQ(options[0].kind, StepKind::kIntermediate);
  EXPECT_NEAR(options[0].T_previous_this.x_m, 3.0, 1e-12);
  EXPECT_NEAR(options[0].T_previous_this.y_m, -2.0, 1e-12);
  EXPECT_NEAR(options[0].T_previous_this.theta_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(options[0].fitness, 0.6);
  // 0.2 m and 0.1 m, and the heading of 12 at the 2 m and 3 m from it.
  EXPECT_NEAR(options[0].covariance(2, 2), 2 * 0.02 * 0.02, 1e-12);
  EXPECT_GT(options[0].covariance(0, 0), 0.2 * 0.2 + 0.1 * 0.1 - 1e-12);
}

TEST(StepOptions, AreOdometryWhereTheIntermediateMapKnowsOnlyOne) {
  SolutionStore solutions;
  solutions.put(11, 13, {{{3.0, 0.0, 0.0}, covariance_of(0.1, 0.02), 0.8}});
  const auto options = step_options(five_poses(), solutions, {}, 3);
  ASSERT_EQ(options.size(), 1U);
  EXPECT_EQ(options[0].kind, StepKind::kOdometry);
  EXPECT_EQ(options[0].T_previous_this, (Pose2{1.0, 0.1, 0.2}));
  EXPECT_EQ(options[0].fitness, 0.0);
}

TEST(StepOptions, AreAGridWhereNothingOverlaps) {
  BackwardProblem problem = five_poses();
  problem.poses[3].overlaps.clear();
  BackwardConfig config;
  config.largest_grid = 100'000;
  const auto options = step_options(problem, SolutionStore(), config, 3);
  // 99 %: 3.03 deviations of 0.2 m are 0.61 m, four spacings of 0.15 m; 3 x 0.05 rad are four of
  // 2 degrees.
  EXPECT_EQ(options.size(), 9U * 9U * 9U);
  EXPECT_EQ(options.front().T_previous_this, (Pose2{1.0, 0.1, 0.2}));
  const Eigen::Vector3d half = search_half_width(covariance_of(0.2, 0.05), 0.99, 3.0);
  for (const StepOption& option : options) {
    EXPECT_EQ(option.kind, StepKind::kGrid);
    const Eigen::Vector3d off = geometry::difference(option.T_previous_this, {1.0, 0.1, 0.2});
    EXPECT_TRUE((off.cwiseAbs().array() <= half.array() + 1e-9).all());
  }
  config.largest_grid = 125;
  EXPECT_LE(step_options(problem, SolutionStore(), config, 3).size(), 125U);
  config.largest_grid = 1;
  EXPECT_EQ(step_options(problem, SolutionStore(), config, 3).size(), 1U);
}

}  // namespace
}  // namespace topogeo::localization
