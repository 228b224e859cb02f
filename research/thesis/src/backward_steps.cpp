// step_options(): the steps that lead from one pose of a loop to the next.
#include <algorithm>
#include <cmath>

#include "topogeo/thesis/backward_correction.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Thesis, 7.3.1.2, eqs. 7.23 and 7.24 (docs/algorithms.md, "Backward correction"), with X_{i-1} =
// X_n (+) X_L^(n,i-1): the pose of `this` relative to the previous one through a map n that both
// were matched with, however old.
std::vector<StepOption> intermediate_options(const SolutionStore& solutions, std::uint32_t id,
                                             std::size_t most) {
  std::vector<StepOption> options;
  for (const std::uint32_t n : solutions.matched_with(id)) {
    if (n + 1 >= id) continue;
    for (const RelativeSolution& now : solutions.find(n, id)) {
      for (const RelativeSolution& before : solutions.find(n, id - 1)) {
        const Pose2 T_previous_n = geometry::inverse(before.T_earlier_later);
        options.push_back(
            {StepKind::kIntermediate, T_previous_n * now.T_earlier_later,
             geometry::compose_covariance(
                 T_previous_n,
                 geometry::inverse_covariance(before.T_earlier_later, before.covariance),
                 now.T_earlier_later, now.covariance),
             std::min(now.fitness, before.fitness)});
      }
    }
  }
  std::stable_sort(options.begin(), options.end(),
                   [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
  if (options.size() > most) options.resize(most);
  return options;
}

// Poses of the search space E_i^{i-1}, its middle first.
std::vector<StepOption> grid_options(const UncertainPose& odometry, const BackwardConfig& config) {
  const Eigen::Vector3d half =
      search_half_width(odometry.covariance, config.probability, config.heading_sigmas);
  Eigen::Vector3d spacing(config.resolution_m, config.resolution_m, config.resolution_rad);
  Eigen::Vector3i count;  // to each side
  for (;;) {
    for (int q = 0; q < 3; ++q) count[q] = static_cast<int>(std::floor(half[q] / spacing[q]));
    const double poses = (2.0 * count[0] + 1) * (2.0 * count[1] + 1) * (2.0 * count[2] + 1);
    if (poses <= static_cast<double>(config.largest_grid)) break;
    constexpr double kWider = 1.25;
    spacing *= kWider;
  }
  std::vector<StepOption> options{{StepKind::kGrid, odometry.T_a_b, odometry.covariance, 0.0}};
  const Eigen::Vector3d cell = spacing.cwiseProduct(spacing) / 12.0;  // variance within a cell
  options.front().covariance = cell.asDiagonal();
  for (int i = -count[0]; i <= count[0]; ++i) {
    for (int j = -count[1]; j <= count[1]; ++j) {
      for (int k = -count[2]; k <= count[2]; ++k) {
        if (i == 0 && j == 0 && k == 0) continue;
        StepOption option = options.front();
        option.T_previous_this = {odometry.T_a_b.x_m + i * spacing.x(),
                                  odometry.T_a_b.y_m + j * spacing.y(),
                                  geometry::wrap_angle(odometry.T_a_b.theta_rad + k * spacing.z())};
        options.push_back(option);
      }
    }
  }
  return options;
}

}  // namespace

std::vector<StepOption> step_options(const BackwardProblem& problem, const SolutionStore& solutions,
                                     const BackwardConfig& config, std::uint32_t k) {
  const std::uint32_t id = problem.first_id + k;
  std::vector<StepOption> options;
  for (const RelativeSolution& solution : solutions.find(id - 1, id)) {
    options.push_back(
        {StepKind::kMatched, solution.T_earlier_later, solution.covariance, solution.fitness});
  }
  if (!options.empty()) return options;
  options = intermediate_options(solutions, id, config.intermediate_steps);
  if (!options.empty()) return options;
  const BackwardPose& pose = problem.poses[k];
  if (pose.overlaps.empty()) return grid_options(pose.T_previous_this, config);
  return {{StepKind::kOdometry, pose.T_previous_this.T_a_b, pose.T_previous_this.covariance, 0.0}};
}

}  // namespace topogeo::localization
