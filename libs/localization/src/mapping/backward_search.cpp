#include "backward_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// With no solution at all on the way the distance from the expected pose still has to rank walks.
constexpr double kLeastMeanFitness = 0.1;

// Covariance of the frame of a pose, seen in the frame that the pose is given in.
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Pose2& T_first_pose) {
  return geometry::compose_covariance(Pose2{0.0, 0.0, T_first_pose.theta_rad},
                                      Eigen::Matrix3d::Zero(), Pose2{}, covariance);
}

}  // namespace

BackwardSearch::BackwardSearch(const BackwardProblem& problem, const SolutionStore& solutions,
                               const BackwardConfig& config)
    : problem_(problem),
      config_(config),
      last_(static_cast<std::uint32_t>(problem.poses.size() - 1)),
      levels_(problem.poses.size()) {
  describe_levels(solutions);
}

void BackwardSearch::describe_levels(const SolutionStore& solutions) {
  for (std::uint32_t k = 1; k <= last_; ++k) {
    Level& level = levels_[k];
    const UncertainPose& expected = problem_.poses[k].T_first_this;
    level.T_first_expected = expected.T_a_b;
    level.covariance = expected.covariance;
    level.information = expected.covariance.inverse();
    level.half_width =
        search_half_width(expected.covariance, config_.probability, config_.heading_sigmas)
            .cwiseMax(Eigen::Vector3d(config_.resolution_m, config_.resolution_m,
                                      config_.resolution_rad));
    const std::vector<StepOption> options = step_options(problem_, solutions, config_, k);
    for (const StepOption& option : options) {
      level.steps.push_back(
          {geometry::inverse(option.T_previous_this),
           geometry::inverse_covariance(option.T_previous_this, option.covariance),
           option.fitness});
    }
    mean_fitness_ += options.front().fitness / last_;
    if (k == 1) first_step_ = options;
    for (const std::uint32_t id : problem_.poses[k].overlaps) {
      if (k == last_ || id < problem_.first_id) continue;
      levels_[id - problem_.first_id].seen_by.push_back(k);
    }
  }
  mean_fitness_ = std::max(mean_fitness_, kLeastMeanFitness);
  for (const BackwardCandidate& candidate : problem_.candidates) {
    levels_[candidate.via - problem_.first_id].is_via = true;
  }
}

// K = S (S + C)^-1 takes the pose (covariance S) to the mean of it and of the expected one (C).
BackwardSearch::Draw BackwardSearch::draw(const Level& level, const Pose2& T_first_pose,
                                          const Eigen::Matrix3d& covariance) const {
  const Eigen::Vector3d gap = geometry::difference(level.T_first_expected, T_first_pose);
  const Eigen::Matrix3d sum = covariance + level.covariance;
  const Eigen::Vector3d share = sum.inverse() * gap;
  const Eigen::Vector3d step = covariance * share;
  return {{T_first_pose.x_m + step.x(), T_first_pose.y_m + step.y(),
           geometry::wrap_angle(T_first_pose.theta_rad + step.z())},
          share.dot(step)};
}

// Step 2 of the source, and the rank.
void BackwardSearch::offer(Level& level, const Pose2& T_first_pose, double fitness,
                           std::uint32_t parent) {
  const Eigen::Vector3d off = geometry::difference(T_first_pose, level.T_first_expected);
  if ((off.cwiseAbs().array() > level.half_width.array()).any()) return;
  const double to_come = 0.5 * mean_fitness_ * off.dot(level.information * off);
  level.waiting.push_back({T_first_pose, fitness, fitness - to_come, parent});
}

void BackwardSearch::seed() {
  Level& level = levels_[last_];
  for (std::uint32_t i = 0; i < problem_.candidates.size(); ++i) {
    const BackwardCandidate& candidate = problem_.candidates[i];
    offer(level, candidate.T_first_last.T_a_b, candidate.fitness, i);
    if (!config_.draw) continue;
    const Draw drawn = draw(level, candidate.T_first_last.T_a_b, candidate.T_first_last.covariance);
    if (drawn.distance2 > config_.largest_draw2) continue;
    offer(level, drawn.T_first_pose, candidate.fitness * geometry::exp(-0.5 * drawn.distance2), i);
  }
  std::stable_sort(level.waiting.begin(), level.waiting.end(),
                   [](const Node& a, const Node& b) { return a.rank > b.rank; });
}

// Step 1 of the source for all walks that have come to pose k.
void BackwardSearch::expand(std::uint32_t k) {
  const Level& from = levels_[k];
  Level& level = levels_[k - 1];
  level.waiting.clear();
  level.next_waiting = 0;
  for (std::uint32_t i = 0; i < from.nodes.size(); ++i) {
    const Node& node = from.nodes[i];
    ++expanded_;
    for (const Level::Step& step : from.steps) {
      const Pose2 T_first_pose = node.T_first_pose * step.T_this_previous;
      ++work_;
      offer(level, T_first_pose, node.fitness + step.fitness, i);
      if (!config_.draw) continue;
      const Draw drawn = draw(level, T_first_pose, turned(step.covariance, node.T_first_pose));
      ++work_;
      if (drawn.distance2 > config_.largest_draw2) continue;
      offer(level, drawn.T_first_pose,
            node.fitness + step.fitness * geometry::exp(-0.5 * drawn.distance2), i);
    }
  }
  std::stable_sort(level.waiting.begin(), level.waiting.end(),
                   [](const Node& a, const Node& b) { return a.rank > b.rank; });
}

bool BackwardSearch::take(std::uint32_t k) {
  Level& level = levels_[k];
  level.nodes.clear();
  const std::size_t left = level.waiting.size() - level.next_waiting;
  const bool crowded = left > config_.beam_width;
  std::set<std::array<std::int64_t, 3>> places;
  const auto cell = [](double value, double size) {
    return static_cast<std::int64_t>(std::floor(value / size));
  };
  while (level.next_waiting < level.waiting.size() && level.nodes.size() < config_.beam_width) {
    const Node& node = level.waiting[level.next_waiting++];
    if (crowded && !places
                        .insert({cell(node.T_first_pose.x_m, config_.same_place_m),
                                 cell(node.T_first_pose.y_m, config_.same_place_m),
                                 cell(node.T_first_pose.theta_rad, config_.same_place_rad)})
                        .second) {
      continue;
    }
    if (still_overlaps(k, node)) level.nodes.push_back(node);
  }
  const std::size_t end = level.next_waiting + config_.waiting;
  if (level.waiting.size() > end) level.waiting.resize(end);
  return !level.nodes.empty();
}

// The second rule of rejection: maps that overlapped must do so where the walk puts them.
bool BackwardSearch::still_overlaps(std::uint32_t k, const Node& node) const {
  const Level& level = levels_[k];
  const auto sees = [&](std::uint32_t later, const Pose2& T_first_later) {
    const FieldOfView seen =
        seen_from(problem_.poses[later].view, geometry::between(node.T_first_pose, T_first_later),
                  Eigen::Vector3d::Zero());
    return overlap(seen, problem_.poses[k].view);
  };
  if (k == last_) {
    const std::uint32_t via = problem_.candidates[node.parent].via - problem_.first_id;
    const Pose2 T_first_via = via == 0 ? Pose2{} : levels_[via].T_first_expected;
    return overlap(
        seen_from(problem_.poses[k].view, geometry::between(T_first_via, node.T_first_pose),
                  Eigen::Vector3d::Zero()),
        problem_.poses[via].view);
  }
  const std::uint32_t farthest =
      level.is_via ? last_ : (level.seen_by.empty() ? k : level.seen_by.back());
  std::uint32_t index = node.parent;
  std::size_t next = 0;
  for (std::uint32_t later = k + 1; later <= farthest; ++later) {
    const Node& behind = levels_[later].nodes[index];
    if (next < level.seen_by.size() && level.seen_by[next] == later) {
      if (!sees(later, behind.T_first_pose)) return false;
      ++next;
    }
    if (later == last_ && problem_.candidates[behind.parent].via == problem_.first_id + k &&
        !sees(later, behind.T_first_pose)) {
      return false;
    }
    index = behind.parent;
  }
  return true;
}

BackwardResult BackwardSearch::run() {
  BackwardResult result;
  result.nearest_id = problem_.first_id + last_;
  if (problem_.candidates.empty()) return result;
  result.outcome = BackwardOutcome::kCandidatesOutside;
  seed();
  std::uint32_t k = last_;
  std::uint32_t nearest = last_ + 1;
  bool found = take(k);
  for (;;) {
    if (!found) {  // step 3.2: up to the nearest pose at which walks wait
      while (k <= last_ && levels_[k].next_waiting >= levels_[k].waiting.size()) ++k;
      if (k > last_) break;
      ++result.backtracks;
      found = take(k);
      continue;
    }
    nearest = std::min(nearest, k);
    if (k == 1) {
      result.outcome = BackwardOutcome::kClosed;
      collect(result);
      break;
    }
    result.outcome = BackwardOutcome::kDeadEnd;
    if (work_ >= config_.largest_work) {
      result.outcome = BackwardOutcome::kTooMuchWork;
      break;
    }
    expand(k);
    found = take(--k);
  }
  result.nearest_id = problem_.first_id + std::min(nearest, last_);
  result.expanded = expanded_;
  result.work = work_;
  return result;
}

// The walks that have reached the pose next to the first one, the winner by summed fitness first.
// The step on to the first pose, which keeps its place, counts too: else a walk could leave its
// whole gap there.
void BackwardSearch::collect(BackwardResult& result) const {
  struct End {
    double fitness = 0.0;
    std::uint32_t index = 0;
  };
  std::vector<End> ends;
  for (std::uint32_t i = 0; i < levels_[1].nodes.size(); ++i) {
    const Node& node = levels_[1].nodes[i];
    double best = 0.0;
    for (const StepOption& option : first_step_) {
      const Eigen::Vector3d off = geometry::difference(node.T_first_pose, option.T_previous_this);
      const double distance2 = off.dot(option.covariance.inverse() * off);
      best = std::max(best, option.fitness * geometry::exp(-0.5 * distance2));
    }
    ends.push_back({node.fitness + best, i});
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const End& a, const End& b) { return a.fitness > b.fitness; });
  if (ends.size() > config_.ways_wanted) ends.resize(config_.ways_wanted);
  for (const End& end : ends) {
    BackwardWay way;
    way.summed_fitness = end.fitness;
    way.T_first_pose.resize(problem_.poses.size());
    std::uint32_t index = end.index;
    for (std::uint32_t k = 1; k <= last_; ++k) {
      const Node& node = levels_[k].nodes[index];
      way.T_first_pose[k] = node.T_first_pose;
      index = node.parent;
    }
    way.candidate = index;
    result.ways.push_back(std::move(way));
  }
}

}  // namespace topogeo::localization
