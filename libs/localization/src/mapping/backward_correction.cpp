#include "topogeo/localization/mapping/backward_correction.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "backward_search.hpp"

namespace topogeo::localization {

namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("backward correction: " + what);
}

void check_covariance(const Eigen::Matrix3d& covariance, const std::string& of) {
  if (!covariance.allFinite() ||
      covariance.selfadjointView<Eigen::Lower>().llt().info() != Eigen::Success) {
    refuse("the covariance of " + of + " is not positive definite");
  }
}

void check_backward(const BackwardConfig& config) {
  if (config.beam_width == 0 || config.ways_wanted == 0 || config.largest_grid == 0) {
    refuse("beam_width, ways_wanted and largest_grid must be at least 1");
  }
  if (!(config.resolution_m > 0.0 && config.resolution_rad > 0.0 && config.same_place_m > 0.0 &&
        config.same_place_rad > 0.0)) {
    refuse("resolutions and same_place must be positive");
  }
}

void check_backward(const BackwardProblem& problem) {
  const std::size_t poses = problem.poses.size();
  if (poses < 2) refuse("a loop has at least two poses, got " + std::to_string(poses));
  for (std::size_t k = 1; k < poses; ++k) {
    const std::uint64_t id = problem.first_id + k;
    const std::string name = "pose " + std::to_string(id);
    check_covariance(problem.poses[k].T_first_this.covariance, name);
    check_covariance(problem.poses[k].T_previous_this.covariance, "the odometry to " + name);
    for (const std::uint32_t earlier : problem.poses[k].overlaps) {
      if (earlier >= id)
        refuse(name + " overlaps with " + std::to_string(earlier) + ", which is not earlier");
    }
  }
  for (const BackwardCandidate& candidate : problem.candidates) {
    if (candidate.via < problem.first_id || candidate.via >= problem.first_id + poses - 1) {
      refuse("a candidate comes via map " + std::to_string(candidate.via) +
             ", which is not an earlier one of the loop");
    }
    if (!(candidate.fitness >= 0.0 && candidate.fitness <= 1.0)) {
      refuse("the fitness " + std::to_string(candidate.fitness) +
             " of a candidate is not in [0, 1]");
    }
    check_covariance(candidate.T_first_last.covariance, "a candidate");
  }
}

// The best solution, and a covariance that covers the others as far as they are as fit.
UncertainPose mixture(const LoopStep& step) {
  const RelativeSolution& best = step.front();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double weights = 0.0;
  for (const RelativeSolution& solution : step) {
    const Eigen::Vector3d off =
        geometry::difference(solution.T_earlier_later, best.T_earlier_later);
    const double weight = step.size() == 1 ? 1.0 : solution.fitness;
    sum += weight * (solution.covariance + off * off.transpose());
    weights += weight;
  }
  return {best.T_earlier_later, weights > 0.0 ? Eigen::Matrix3d(sum / weights) : best.covariance};
}

}  // namespace

const char* to_string(BackwardOutcome outcome) {
  static constexpr std::array<const char*, 5> kNames{"closed", "no candidates",
                                                     "candidates outside of their uncertainty",
                                                     "dead end", "too much work"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

BackwardResult correct_backward(const BackwardProblem& problem, const SolutionStore& solutions,
                                const BackwardConfig& config) {
  check_backward(config);
  check_backward(problem);
  return BackwardSearch(problem, solutions, config).run();
}

ClosingCheck check_closing(std::span<const LoopStep> steps, const RelativeSolution& closing,
                           std::span<const FieldOfView> views, const BackwardConfig& config) {
  if (!views.empty() && views.size() != steps.size() + 1) {
    refuse("one view for each pose of the loop is needed, or none");
  }
  BackwardProblem problem;
  problem.poses.resize(steps.size() + 1);
  SolutionStore solutions(std::max<std::size_t>(1, config.beam_width));
  ClosingCheck check_backward;
  check_backward.best_fitness = closing.fitness;
  for (std::uint32_t k = 0; k <= steps.size(); ++k) {
    BackwardPose& pose = problem.poses[k];
    // Without views every map is taken to see every other.
    pose.view = views.empty() ? FieldOfView{{-1e9, -1e9}, {1e9, 1e9}} : views[k];
    if (k == 0) continue;
    const LoopStep& step = steps[k - 1];
    if (step.empty()) refuse("step " + std::to_string(k) + " has no solution");
    const UncertainPose& before = problem.poses[k - 1].T_first_this;
    const RelativeSolution& best = step.front();
    pose.T_previous_this = mixture(step);
    pose.T_first_this = {
        before.T_a_b * best.T_earlier_later,
        geometry::compose_covariance(before.T_a_b, before.covariance, best.T_earlier_later,
                                     pose.T_previous_this.covariance)};
    const FieldOfView seen = seen_from(pose.view, best.T_earlier_later, Eigen::Vector3d::Zero());
    if (overlap(seen, problem.poses[k - 1].view)) pose.overlaps = {k - 1};
    check_backward.best_fitness += best.fitness;
    solutions.put(k - 1, k, step);
  }
  problem.candidates.push_back({0, {closing.T_earlier_later, closing.covariance}, closing.fitness});
  const BackwardResult result = correct_backward(problem, solutions, config);
  check_backward.outcome = result.outcome;
  check_backward.consistent = result.outcome == BackwardOutcome::kClosed;
  if (check_backward.consistent) {
    check_backward.summed_fitness = result.ways.front().summed_fitness;
    check_backward.T_first_pose = result.ways.front().T_first_pose;
  }
  return check_backward;
}

}  // namespace topogeo::localization
