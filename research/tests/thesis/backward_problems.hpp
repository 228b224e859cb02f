// Loops for the tests and the benchmark of the backward correction.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/thesis/backward_correction.hpp"

namespace topogeo::localization::test {

inline Eigen::Matrix3d covariance_of(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

/// A loop of poses with the result of the forward correction.
struct Loop {
  BackwardProblem problem;
  SolutionStore solutions{40};
  std::vector<geometry::Pose2> T_first_true;
};

struct LoopOptions {
  std::uint32_t poses = 60;
  double step_m = 1.5;
  double sigma_m = 0.05;  ///< of a stored solution
  double sigma_rad = 0.01;
  double heading_bias_rad = 0.0;  ///< of every step of the forward correction
  std::uint32_t solutions_per_step = 3;
  std::uint32_t candidates = 40;  ///< of the last pose; the first one is right
};

/// A circle back to its first pose. The best stored solution of a step is the truth with noise and
/// a bias of the heading, the others are off by a resolution of the genetic search; all candidates
/// but one are wrong by 4 m to 12 m, and half of them are fitter.
inline Loop circle(const LoopOptions& options, std::uint64_t seed) {
  support::Random random(seed);
  Loop loop;
  const double turn_rad = 2.0 * std::numbers::pi / options.poses;
  const geometry::Pose2 T_step{options.step_m, 0.0, turn_rad};
  loop.problem.poses.resize(options.poses);
  loop.T_first_true.resize(options.poses);
  const auto noisy = [&](const geometry::Pose2& pose, double scale) {
    return geometry::Pose2{
        pose.x_m + scale * options.sigma_m * random.normal(),
        pose.y_m + scale * options.sigma_m * random.normal(),
        geometry::wrap_angle(pose.theta_rad + scale * options.sigma_rad * random.normal())};
  };
  for (std::uint32_t k = 0; k < options.poses; ++k) {
    BackwardPose& pose = loop.problem.poses[k];
    pose.view = {{0.0, -4.0}, {8.0, 4.0}};
    if (k == 0) continue;
    loop.T_first_true[k] = loop.T_first_true[k - 1] * T_step;
    geometry::Pose2 T_best = noisy(T_step, 1.0);
    T_best.theta_rad += options.heading_bias_rad;
    std::vector<RelativeSolution> found{
        {T_best, covariance_of(options.sigma_m, options.sigma_rad), 0.8}};
    for (std::uint32_t i = 1; i < options.solutions_per_step; ++i) {
      found.push_back({noisy(T_best, 3.0), covariance_of(options.sigma_m, options.sigma_rad),
                       random.uniform(0.3, 0.7)});
    }
    loop.solutions.put(k - 1, k, found);
    const UncertainPose& before = loop.problem.poses[k - 1].T_first_this;
    pose.T_first_this = {
        before.T_a_b * T_best,
        geometry::compose_covariance(before.T_a_b, before.covariance, T_best, found[0].covariance)};
    pose.T_previous_this = {T_best, covariance_of(0.3, 0.1)};
    pose.overlaps.push_back(k - 1);
    if (k > 1) pose.overlaps.push_back(k - 2);
  }
  const Eigen::Matrix3d closing = covariance_of(options.sigma_m, options.sigma_rad);
  const geometry::Pose2 T_first_last = loop.T_first_true.back();
  for (std::uint32_t i = 0; i < options.candidates; ++i) {
    geometry::Pose2 pose = noisy(T_first_last, 1.0);
    if (i > 0) {
      const double away_m = random.uniform(4.0, 12.0);
      const double direction_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
      pose = {pose.x_m + away_m * std::cos(direction_rad),
              pose.y_m + away_m * std::sin(direction_rad),
              pose.theta_rad + random.uniform(-0.3, 0.3)};
    }
    loop.problem.candidates.push_back(
        {0, {pose, closing}, i == 0 ? 0.7 : random.uniform(0.5, 0.9)});
  }
  return loop;
}

}  // namespace topogeo::localization::test
