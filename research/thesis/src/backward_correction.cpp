#include "topogeo/thesis/backward_correction.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

[[noreturn]] void refuse_backward(const std::string& what) {
  throw std::invalid_argument("backward correction: " + what);
}

void check_backward(const BackwardProblem& problem, const BackwardConfig& config) {
  if (config.largest_grid == 0) refuse_backward("largest_grid must be at least 1");
  if (!(config.resolution_m > 0.0 && config.resolution_rad > 0.0)) {
    refuse_backward("resolutions must be positive");
  }
  const std::size_t poses = problem.poses.size();
  if (poses < 2) {
    refuse_backward("expected a loop of at least two poses, got " + std::to_string(poses));
  }
  for (std::size_t k = 1; k < poses; ++k) {
    const std::uint64_t id = problem.first_id + k;
    const std::string name = "pose " + std::to_string(id);
    const Eigen::Matrix3d& odometry = problem.poses[k].T_previous_this.covariance;
    if (!odometry.allFinite() ||
        odometry.selfadjointView<Eigen::Lower>().llt().info() != Eigen::Success) {
      refuse_backward("the covariance of the odometry to " + name + " is not positive definite");
    }
    for (const std::uint32_t earlier : problem.poses[k].overlaps) {
      if (earlier >= id) {
        refuse_backward(name + " overlaps with " + std::to_string(earlier) +
                        ", expected an earlier one");
      }
    }
  }
  for (const BackwardCandidate& candidate : problem.candidates) {
    if (candidate.via < problem.first_id || candidate.via >= problem.first_id + poses - 1) {
      refuse_backward("a candidate leads through map " + std::to_string(candidate.via) +
                      ", expected an earlier one of the loop");
    }
  }
}

// The second rule of rejection in 7.3.1.2: maps that overlapped must still do so at the poses of
// the path.
class OverlapConstraint : public LoopConstraint {
 public:
  explicit OverlapConstraint(const BackwardProblem& problem)
      : problem_(problem),
        last_(static_cast<std::uint32_t>(problem.poses.size() - 1)),
        seen_by_(problem.poses.size()),
        is_via_(problem.poses.size(), false) {
    for (std::uint32_t k = 1; k < last_; ++k) {
      for (const std::uint32_t id : problem.poses[k].overlaps) {
        if (id >= problem.first_id) seen_by_[id - problem.first_id].push_back(k);
      }
    }
    for (const BackwardCandidate& candidate : problem.candidates) {
      is_via_[candidate.via - problem.first_id] = true;
    }
  }

  [[nodiscard]] bool allows(std::uint32_t k, const LoopNode& node) const override {
    const std::uint32_t via = problem_.candidates[node.candidate].via - problem_.first_id;
    if (k == last_) {
      const Pose2 T_first_via = via == 0 ? Pose2{} : problem_.poses[via].T_first_this.T_a_b;
      return sees(k, node.T_first_pose, via, T_first_via);
    }
    const std::vector<std::uint32_t>& seen_by = seen_by_[k];
    const std::uint32_t farthest = is_via_[k] ? last_ : (seen_by.empty() ? k : seen_by.back());
    const LoopNode* behind = node.next;
    std::size_t next = 0;
    for (std::uint32_t later = k + 1; later <= farthest; ++later, behind = behind->next) {
      const bool overlapped = next < seen_by.size() && seen_by[next] == later;
      if (overlapped) ++next;
      if ((overlapped || (later == last_ && via == k)) &&
          !sees(later, behind->T_first_pose, k, node.T_first_pose)) {
        return false;
      }
    }
    return true;
  }

 private:
  [[nodiscard]] bool sees(std::uint32_t later, const Pose2& T_first_later, std::uint32_t earlier,
                          const Pose2& T_first_earlier) const {
    const topomap::VisibleRectangle seen =
        seen_from(problem_.poses[later].view, geometry::between(T_first_earlier, T_first_later),
                  Eigen::Vector3d::Zero());
    return overlap(seen, problem_.poses[earlier].view);
  }

  const BackwardProblem& problem_;
  std::uint32_t last_;
  std::vector<std::vector<std::uint32_t>> seen_by_;  // later poses whose maps overlap, ascending
  std::vector<bool> is_via_;                         // by pose: a candidate names it
};

}  // namespace

BackwardResult correct_backward(const BackwardProblem& problem, const SolutionStore& solutions,
                                const BackwardConfig& config) {
  check_backward(problem, config);
  std::vector<LoopPose> poses(problem.poses.size());
  for (std::uint32_t k = 1; k < poses.size(); ++k) {
    poses[k].T_first_this = problem.poses[k].T_first_this;
    for (const StepOption& option : step_options(problem, solutions, config, k)) {
      poses[k].steps.push_back({option.T_previous_this, option.covariance, option.fitness});
    }
  }
  std::vector<LoopCandidate> candidates;
  candidates.reserve(problem.candidates.size());
  for (const BackwardCandidate& candidate : problem.candidates) {
    candidates.push_back({candidate.T_first_last, candidate.fitness});
  }
  const OverlapConstraint overlaps(problem);
  BackwardResult result{search_loop(poses, candidates, config, &overlaps), 0};
  result.nearest_id = problem.first_id + result.nearest;
  return result;
}

}  // namespace topogeo::localization
