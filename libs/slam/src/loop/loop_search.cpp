#include "loop/loop_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Without any match along the loop, the distance from the expected pose still has to rank paths.
constexpr double kLeastMeanFitness = 0.1;
// Squared deviations: limits a draw to 3, which is enough for nearly all right steps.
constexpr double kLargestDraw2 = 9.0;
// Paths nearer to each other than this count as one, because the errors of a refined match are of
// this size: if there are too many paths, only the best of them is kept.
constexpr double kSamePlace_m = 0.03;
constexpr double kSamePlace_rad = 0.01;

[[noreturn]] void refuse_loop(const std::string& what) {
  throw std::invalid_argument("loop search: " + what);
}

void check_covariance(const Eigen::Matrix3d& covariance, const std::string& of) {
  if (!covariance.allFinite() ||
      covariance.selfadjointView<Eigen::Lower>().llt().info() != Eigen::Success) {
    refuse_loop("the covariance of " + of + " is not positive definite");
  }
}

void check_loop(std::span<const LoopPose> poses, std::span<const LoopCandidate> candidates,
                const LoopSearchConfig& config) {
  if (config.beam_width == 0 || config.paths_wanted == 0) {
    refuse_loop("beam_width and paths_wanted must be at least 1");
  }
  if (!(config.resolution_m > 0.0 && config.resolution_rad > 0.0)) {
    refuse_loop("resolutions must be positive");
  }
  if (poses.size() < 2) {
    refuse_loop("expected a loop of at least two poses, got " + std::to_string(poses.size()));
  }
  for (std::size_t k = 1; k < poses.size(); ++k) {
    check_covariance(poses[k].T_first_this.covariance, "pose " + std::to_string(k));
    if (poses[k].steps.empty()) refuse_loop("no step leads to pose " + std::to_string(k));
  }
  for (const LoopCandidate& candidate : candidates) {
    if (!(candidate.fitness >= 0.0 && candidate.fitness <= 1.0)) {
      refuse_loop("the fitness " + std::to_string(candidate.fitness) +
                  " of a candidate is not in [0, 1]");
    }
    check_covariance(candidate.T_first_last.covariance, "a candidate");
  }
}

// Turns a covariance in the frame of a pose into the frame that the pose is given in.
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Pose2& T_first_pose) {
  return geometry::compose_covariance(Pose2{0.0, 0.0, T_first_pose.theta_rad},
                                      Eigen::Matrix3d::Zero(), Pose2{}, covariance);
}

class LoopSearch {
 public:
  // All must outlive the search; the input has been checked.
  LoopSearch(std::span<const LoopPose> poses, std::span<const LoopCandidate> candidates,
             const LoopSearchConfig& config, const LoopConstraint* constraint);

  LoopSearchResult run();

 private:
  // A step from a pose back to the previous one.
  struct Step {
    Pose2 T_this_previous;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // in the frame of this pose
    double fitness = 0.0;
  };
  // One pose of the loop.
  struct Level {
    Pose2 T_first_expected;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
    Eigen::Vector3d half_width = Eigen::Vector3d::Zero();
    std::vector<Step> steps;
    std::vector<LoopNode> nodes;
    std::vector<LoopNode> waiting;  // best first
    std::size_t next_waiting = 0;
  };
  // A pose drawn towards its expected place.
  struct Draw {
    Pose2 T_first_pose;
    double distance2 = 0.0;  // squared deviations from the original pose
  };

  void describe_level(std::uint32_t k);
  void seed();
  void expand(std::uint32_t k);
  void offer(Level& level, const Pose2& T_first_pose, double fitness, const LoopNode* next,
             std::uint32_t candidate) const;
  static void sort_by_rank(Level& level);
  // Activates waiting paths at pose k; false if there are none.
  bool take(std::uint32_t k);
  [[nodiscard]] static Draw draw(const Level& level, const Pose2& T_first_pose,
                                 const Eigen::Matrix3d& covariance);
  void collect(LoopSearchResult& result) const;

  std::span<const LoopPose> poses_;
  std::span<const LoopCandidate> candidates_;
  LoopSearchConfig config_;
  const LoopConstraint* constraint_;
  std::uint32_t last_;
  std::vector<Level> levels_;  // index as in the loop; 0 is not searched
  double mean_fitness_ = 0.0;  // of the best solution of each step
  std::uint64_t expanded_ = 0;
  std::uint64_t work_ = 0;
};

LoopSearch::LoopSearch(std::span<const LoopPose> poses, std::span<const LoopCandidate> candidates,
                       const LoopSearchConfig& config, const LoopConstraint* constraint)
    : poses_(poses),
      candidates_(candidates),
      config_(config),
      constraint_(constraint),
      last_(static_cast<std::uint32_t>(poses.size() - 1)),
      levels_(poses.size()) {
  for (std::uint32_t k = 1; k <= last_; ++k) describe_level(k);
  mean_fitness_ = std::max(mean_fitness_, kLeastMeanFitness);
}

void LoopSearch::describe_level(std::uint32_t k) {
  Level& level = levels_[k];
  const UncertainPose& expected = poses_[k].T_first_this;
  level.T_first_expected = expected.T_a_b;
  level.covariance = expected.covariance;
  level.information = expected.covariance.inverse();
  level.half_width =
      search_half_width(expected.covariance, config_.probability, config_.heading_sigmas)
          .cwiseMax(
              Eigen::Vector3d(config_.resolution_m, config_.resolution_m, config_.resolution_rad));
  for (const RelativeSolution& step : poses_[k].steps) {
    level.steps.push_back({geometry::inverse(step.T_earlier_later),
                           geometry::inverse_covariance(step.T_earlier_later, step.covariance),
                           step.fitness});
  }
  mean_fitness_ += poses_[k].steps.front().fitness / last_;
}

// K = S (S + C)^-1 moves the pose (covariance S) to the mean of it and the expected one (C).
LoopSearch::Draw LoopSearch::draw(const Level& level, const Pose2& T_first_pose,
                                  const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d gap = geometry::difference(level.T_first_expected, T_first_pose);
  const Eigen::Matrix3d sum = covariance + level.covariance;
  const Eigen::Vector3d share = sum.inverse() * gap;
  const Eigen::Vector3d step = covariance * share;
  return {{T_first_pose.x_m + step.x(), T_first_pose.y_m + step.y(),
           geometry::wrap_angle(T_first_pose.theta_rad + step.z())},
          share.dot(step)};
}

// Step 2 of the thesis, and the rank.
void LoopSearch::offer(Level& level, const Pose2& T_first_pose, double fitness,
                       const LoopNode* next, std::uint32_t candidate) const {
  const Eigen::Vector3d off = geometry::difference(T_first_pose, level.T_first_expected);
  if ((off.cwiseAbs().array() > level.half_width.array()).any()) return;
  const double to_come = 0.5 * mean_fitness_ * off.dot(level.information * off);
  level.waiting.push_back({T_first_pose, fitness, fitness - to_come, next, candidate});
}

void LoopSearch::sort_by_rank(Level& level) {
  std::stable_sort(level.waiting.begin(), level.waiting.end(),
                   [](const LoopNode& a, const LoopNode& b) { return a.rank > b.rank; });
}

void LoopSearch::seed() {
  Level& level = levels_[last_];
  for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
    const LoopCandidate& candidate = candidates_[i];
    offer(level, candidate.T_first_last.T_a_b, candidate.fitness, nullptr, i);
    if (!config_.draw) continue;
    const Draw drawn = draw(level, candidate.T_first_last.T_a_b, candidate.T_first_last.covariance);
    if (drawn.distance2 > kLargestDraw2) continue;
    offer(level, drawn.T_first_pose, candidate.fitness * geometry::exp(-0.5 * drawn.distance2),
          nullptr, i);
  }
  sort_by_rank(level);
}

// Step 1 of the thesis for all paths that have reached pose k.
void LoopSearch::expand(std::uint32_t k) {
  const Level& from = levels_[k];
  Level& level = levels_[k - 1];
  level.waiting.clear();
  level.next_waiting = 0;
  for (const LoopNode& node : from.nodes) {
    ++expanded_;
    for (const Step& step : from.steps) {
      const Pose2 T_first_pose = node.T_first_pose * step.T_this_previous;
      ++work_;
      offer(level, T_first_pose, node.fitness + step.fitness, &node, node.candidate);
      if (!config_.draw) continue;
      const Draw drawn = draw(level, T_first_pose, turned(step.covariance, node.T_first_pose));
      ++work_;
      if (drawn.distance2 > kLargestDraw2) continue;
      offer(level, drawn.T_first_pose,
            node.fitness + step.fitness * geometry::exp(-0.5 * drawn.distance2), &node,
            node.candidate);
    }
  }
  sort_by_rank(level);
}

bool LoopSearch::take(std::uint32_t k) {
  Level& level = levels_[k];
  level.nodes.clear();
  const std::size_t left = level.waiting.size() - level.next_waiting;
  const bool crowded = left > config_.beam_width;
  std::set<std::array<std::int64_t, 3>> places;
  const auto cell = [](double value, double size) {
    return static_cast<std::int64_t>(std::floor(value / size));
  };
  while (level.next_waiting < level.waiting.size() && level.nodes.size() < config_.beam_width) {
    const LoopNode& node = level.waiting[level.next_waiting++];
    if (crowded && !places
                        .insert({cell(node.T_first_pose.x_m, kSamePlace_m),
                                 cell(node.T_first_pose.y_m, kSamePlace_m),
                                 cell(node.T_first_pose.theta_rad, kSamePlace_rad)})
                        .second) {
      continue;
    }
    if (constraint_ == nullptr || constraint_->allows(k, node)) level.nodes.push_back(node);
  }
  const std::size_t end = level.next_waiting + config_.waiting;
  if (level.waiting.size() > end) level.waiting.resize(end);
  return !level.nodes.empty();
}

LoopSearchResult LoopSearch::run() {
  LoopSearchResult result;
  result.nearest = last_;
  if (candidates_.empty()) return result;
  result.outcome = LoopSearchOutcome::kCandidatesOutside;
  seed();
  std::uint32_t k = last_;
  std::uint32_t nearest = last_ + 1;
  bool found = take(k);
  for (;;) {
    if (!found) {  // step 3.2 of the thesis: up to the nearest pose with waiting paths
      while (k <= last_ && levels_[k].next_waiting >= levels_[k].waiting.size()) ++k;
      if (k > last_) break;
      ++result.backtracks;
      found = take(k);
      continue;
    }
    nearest = std::min(nearest, k);
    if (k == 1) {
      result.outcome = LoopSearchOutcome::kClosed;
      collect(result);
      break;
    }
    result.outcome = LoopSearchOutcome::kDeadEnd;
    if (work_ >= config_.largest_work) {
      result.outcome = LoopSearchOutcome::kTooMuchWork;
      break;
    }
    expand(k);
    found = take(--k);
  }
  result.nearest = std::min(nearest, last_);
  result.expanded = expanded_;
  result.work = work_;
  return result;
}

// Collects the paths that have reached the pose next to the first one, largest summed fitness
// first. The step to the first pose, which is fixed, counts too: otherwise a path could leave its
// whole gap there.
void LoopSearch::collect(LoopSearchResult& result) const {
  struct End {
    double fitness = 0.0;
    const LoopNode* node = nullptr;
  };
  std::vector<End> ends;
  for (const LoopNode& node : levels_[1].nodes) {
    double best = 0.0;
    for (const RelativeSolution& step : poses_[1].steps) {
      const Eigen::Vector3d off = geometry::difference(node.T_first_pose, step.T_earlier_later);
      const double distance2 = geometry::squared_mahalanobis(off, step.covariance);
      best = std::max(best, step.fitness * geometry::exp(-0.5 * distance2));
    }
    ends.push_back({node.fitness + best, &node});
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const End& a, const End& b) { return a.fitness > b.fitness; });
  if (ends.size() > config_.paths_wanted) ends.resize(config_.paths_wanted);
  for (const End& end : ends) {
    LoopPath path;
    path.summed_fitness = end.fitness;
    path.candidate = end.node->candidate;
    path.T_first_pose.resize(poses_.size());
    const LoopNode* node = end.node;
    for (std::uint32_t k = 1; k <= last_; ++k, node = node->next) {
      path.T_first_pose[k] = node->T_first_pose;
    }
    result.paths.push_back(std::move(path));
  }
}

}  // namespace

const char* to_string(LoopSearchOutcome outcome) {
  static constexpr std::array<const char*, 5> kNames{"closed", "no candidates",
                                                     "candidates outside of their uncertainty",
                                                     "dead end", "too much work"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

LoopSearchResult search_loop(std::span<const LoopPose> poses,
                             std::span<const LoopCandidate> candidates,
                             const LoopSearchConfig& config, const LoopConstraint* constraint) {
  check_loop(poses, candidates, config);
  return LoopSearch(poses, candidates, config, constraint).run();
}

}  // namespace topogeo::localization
