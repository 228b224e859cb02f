#include "loop/closing_check.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::uint32_t kPoses = 60;
constexpr double kStepSigma_m = 0.05;
constexpr double kStepSigma_rad = 0.01;

Eigen::Matrix3d covariance_of(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

/// A circle back to its first pose; each step has one solution, the truth with noise.
struct Circle {
  std::vector<LoopStep> steps;
  Pose2 T_first_last;

  Circle() {
    support::Random random(8);
    const Pose2 T_step{1.5, 0.0, 2.0 * std::numbers::pi / kPoses};
    for (std::uint32_t k = 1; k < kPoses; ++k) {
      T_first_last = T_first_last * T_step;
      const Pose2 T_noisy{T_step.x_m + kStepSigma_m * random.normal(),
                          T_step.y_m + kStepSigma_m * random.normal(),
                          T_step.theta_rad + kStepSigma_rad * random.normal()};
      steps.push_back({{T_noisy, covariance_of(kStepSigma_m, kStepSigma_rad), 0.8}});
    }
  }
};

TEST(CheckClosing, AcceptsAClosingThatFitsAndRefusesOneThatDoesNot) {
  const auto& [steps, T_first_last] = Circle();
  const Eigen::Matrix3d covariance = covariance_of(kStepSigma_m, kStepSigma_rad);
  const ClosingCheck right = check_closing(steps, {T_first_last, covariance, 0.8});
  ASSERT_TRUE(right.consistent);
  EXPECT_NEAR(right.best_fitness, kPoses * 0.8, 1e-9);
  EXPECT_GT(right.summed_fitness, 0.85 * right.best_fitness);
  EXPECT_LE(right.summed_fitness, right.best_fitness);
  Pose2 wrong = T_first_last;
  wrong.x_m += 30.0;
  const ClosingCheck refused = check_closing(steps, {wrong, covariance, 0.8});
  EXPECT_FALSE(refused.consistent);
  EXPECT_EQ(refused.outcome, LoopSearchOutcome::kCandidatesOutside);
  EXPECT_EQ(refused.summed_fitness, 0.0);
}

TEST(CheckClosing, ASecondSolutionOfAStepCanMakeItFit) {
  const Eigen::Matrix3d covariance = covariance_of(0.02, 0.005);
  std::vector<LoopStep> steps(4, {{{1.0, 0.0, 0.0}, covariance, 0.8}});
  const RelativeSolution closing{{4.3, 0.0, 0.0}, covariance, 0.7};
  EXPECT_FALSE(check_closing(steps, closing).consistent);
  steps[0].push_back({{1.3, 0.0, 0.0}, covariance, 0.7});
  const ClosingCheck found = check_closing(steps, closing);
  ASSERT_TRUE(found.consistent);
  EXPECT_NEAR(found.T_first_pose[1].x_m, 1.3, 0.05);
}

// One step of sigma 0.1 m: its pose must lie within the 99 % ellipse, 3.03 deviations along x.
TEST(CheckClosing, OneStepIsAsWideAsItsEllipse) {
  const std::vector<LoopStep> steps{{{{1.0, 0.0, 0.0}, covariance_of(0.1, 0.01), 1.0}}};
  const auto fits = [&](double x_m) {
    return check_closing(steps, {{x_m, 0.0, 0.0}, covariance_of(1e-4, 1e-4), 0.5}).consistent;
  };
  EXPECT_TRUE(fits(1.30));
  EXPECT_FALSE(fits(1.31));
}

TEST(CheckClosing, RefusesBadInput) {
  const RelativeSolution closing{{1.0, 0.0, 0.0}, covariance_of(0.1, 0.1), 0.5};
  EXPECT_THROW(check_closing({}, closing), std::invalid_argument);
  EXPECT_THROW(check_closing(std::vector<LoopStep>(2), closing), std::invalid_argument);
  const std::vector<LoopStep> steps(2, {closing});
  EXPECT_TRUE(check_closing(steps, {{2.0, 0.0, 0.0}, covariance_of(0.1, 0.1), 0.5}).consistent);
  const auto spoiled = [&](double fitness, double variance) {
    std::vector<LoopStep> bad = steps;
    bad[1][0].fitness = fitness;
    bad[1][0].covariance(0, 0) = variance;
    return bad;
  };
  EXPECT_THROW(check_closing(spoiled(1.1, 0.01), closing), std::invalid_argument);
  EXPECT_THROW(check_closing(spoiled(0.5, 0.0), closing), std::invalid_argument);
  EXPECT_THROW(check_closing(spoiled(0.5, std::nan("")), closing), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
