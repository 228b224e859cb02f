#include "loop/closing_check.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace topogeo::localization {

namespace {

// The best solution, with a covariance that covers the others in proportion to their fitness.
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

void check_step(const LoopStep& step, std::size_t k) {
  const std::string name = "closing check: step " + std::to_string(k);
  if (step.empty()) throw std::invalid_argument(name + " has no solution");
  for (const RelativeSolution& solution : step) {
    if (!(solution.fitness >= 0.0 && solution.fitness <= 1.0)) {
      throw std::invalid_argument(name + " has the fitness " + std::to_string(solution.fitness) +
                                  ", expected [0, 1]");
    }
    if (!solution.covariance.allFinite() || solution.covariance.diagonal().minCoeff() <= 0.0) {
      throw std::invalid_argument(name +
                                  " has a covariance that is not finite with a positive "
                                  "diagonal");
    }
  }
}

}  // namespace

ClosingCheck check_closing(std::span<const LoopStep> steps, const RelativeSolution& closing,
                           const LoopSearchConfig& config) {
  ClosingCheck check;
  check.best_fitness = closing.fitness;
  std::vector<LoopPose> poses(steps.size() + 1);
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const LoopStep& step = steps[k - 1];
    check_step(step, k);
    const UncertainPose& before = poses[k - 1].T_first_this;
    const RelativeSolution& best = step.front();
    poses[k].T_first_this = {
        before.T_a_b * best.T_earlier_later,
        geometry::compose_covariance(before.T_a_b, before.covariance, best.T_earlier_later,
                                     mixture(step).covariance)};
    check.best_fitness += best.fitness;
    poses[k].steps = step;
    std::stable_sort(poses[k].steps.begin(), poses[k].steps.end(),
                     [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
  }
  const std::vector<LoopCandidate> candidates{
      {{closing.T_earlier_later, closing.covariance}, closing.fitness}};
  const LoopSearchResult result = search_loop(poses, candidates, config);
  check.outcome = result.outcome;
  check.consistent = result.outcome == LoopSearchOutcome::kClosed;
  if (check.consistent) {
    check.summed_fitness = result.paths.front().summed_fitness;
    check.T_first_pose = result.paths.front().T_first_pose;
  }
  return check;
}

}  // namespace topogeo::localization
