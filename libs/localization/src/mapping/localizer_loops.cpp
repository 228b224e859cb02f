// The part of Localizer that closes loops: which matches with places of before are believed, and
// what they do to the poses.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "topogeo/localization/mapping/closing_check.hpp"
#include "topogeo/localization/mapping/localizer.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr std::uint32_t kLoopsBetweenOptimizations = 10;
constexpr double kNoticeable_m = 0.1;  // a correction worth an optimisation of its own
constexpr double kMoved_m = 0.1;  // by an optimisation after the end: worth another look around
constexpr double kMoved_rad = 0.02;
constexpr std::uint32_t kLongestWait =
    12;  // stops until a loop that nothing agreed with is dropped

}  // namespace

double Localizer::Correction::way_m() const {
  return std::sqrt((T_map_now.position_m() - T_map_corrected.position_m()).squaredNorm());
}

double Localizer::Correction::turn_rad() const {
  return std::fabs(geometry::wrap_angle(T_map_now.theta_rad - T_map_corrected.theta_rad));
}

Localizer::Correction Localizer::correction_of(const PoseGraphEdge& edge) const {
  return {graph_.poses()[edge.to], graph_.poses()[edge.from] * edge.T_from_to};
}

bool Localizer::far(const Correction& correction) const {
  return correction.way_m() > config_.unaided_correction_m ||
         correction.turn_rad() > config_.unaided_correction_rad;
}

void Localizer::decide(const PoseGraphEdge& edge, LoopOutcome outcome, Reason reason,
                       double fitness) {
  const Correction correction = correction_of(edge);
  decisions_.push_back({static_cast<std::uint32_t>(stops_.size() - 1), edge.from, edge.to, outcome,
                        reason, edge.T_from_to, correction.way_m(), correction.turn_rad(),
                        fitness});
}

// Takes a loop in, or keeps it until another one agrees.
void Localizer::add_loop(const Answer& answer) {
  const PoseGraphEdge& edge = answer.edge;
  const Correction correction = correction_of(edge);
  if (far(correction)) {
    if (!closes(answer)) {
      decide(edge, LoopOutcome::kNoClosing, Reason::kNone, answer.fitness);
      return;
    }
    if (confirm(edge, correction)) {
      decide(edge, LoopOutcome::kAccepted, Reason::kNone, answer.fitness);
      new_loops_.push_back(edge);
      optimization_wanted_ = true;
      return;
    }
    decide(edge, LoopOutcome::kUnconfirmed, Reason::kNone, answer.fitness);
    const Pose2 moved = correction.T_map_corrected * geometry::inverse(correction.T_map_now);
    pending_.push_back({edge, moved});
    stops_[edge.to].compared.erase(
        edge.from);  // it is not in the graph, so it may be compared again
    ++counts_.unconfirmed_loops;
    return;
  }
  decide(edge, LoopOutcome::kAccepted, Reason::kNone, answer.fitness);
  ++loops_since_optimization_;
  if (correction.way_m() > kNoticeable_m) {
    new_loops_.push_back(edge);
    optimization_wanted_ = true;
    return;
  }
  graph_.add_edge(edge);  // it agrees with the poses as they are
  if (loops_since_optimization_ >= kLoopsBetweenOptimizations) optimization_wanted_ = true;
}

// True when the steps of the way between the two stops can be bent to meet the loop.
bool Localizer::closes(const Answer& answer) const {
  std::vector<LoopStep> steps;
  for (std::uint32_t stop = answer.edge.from + 1; stop <= answer.edge.to; ++stop) {
    for (const auto& [from, covariance] : graph_.links_to(stop)) {
      if (from + 1 != stop) continue;
      const Pose2 T_before_stop = geometry::between(graph_.poses()[from], graph_.poses()[stop]);
      steps.push_back({{T_before_stop, covariance, 1.0}});
    }
  }
  return check_closing(steps, {answer.edge.T_from_to, answer.edge.covariance, answer.fitness})
      .consistent;
}

// True when a loop of another stop moves the robot to the same place; that one is taken in too.
bool Localizer::confirm(const PoseGraphEdge& edge, const Correction& correction) {
  const auto same_place = [&](const Pose2& T_map_corrected) {
    return !far({T_map_corrected, correction.T_map_corrected});
  };
  bool confirmed =
      std::any_of(new_loops_.begin(), new_loops_.end(), [&](const PoseGraphEdge& loop) {
        const Correction other = correction_of(loop);
        return loop.to != edge.to &&
               same_place(other.T_map_corrected * geometry::inverse(other.T_map_now) *
                          correction.T_map_now);
      });
  std::erase_if(pending_,
                [&](const PendingLoop& loop) { return loop.edge.to + kLongestWait < edge.to; });
  const auto agrees = [&](const PendingLoop& loop) {
    return loop.edge.to != edge.to && same_place(loop.correction * correction.T_map_now);
  };
  for (const PendingLoop& loop : pending_) {
    if (!agrees(loop)) continue;
    decide(loop.edge, LoopOutcome::kAccepted, Reason::kNone, 0.0);
    new_loops_.push_back(loop.edge);
    confirmed = true;
  }
  std::erase_if(pending_, agrees);
  return confirmed;
}

// --- optimisation

void Localizer::start_optimization(std::uint32_t stop) {
  if (!optimization_wanted_ || due_) return;
  GraphProblem problem{graph_.poses(), graph_.edges()};
  problem.edges.insert(problem.edges.end(), new_loops_.begin(), new_loops_.end());
  started_loops_ = new_loops_.size();
  optimizer().start(std::move(problem));
  due_ = stop + config_.optimization_delay;
  optimization_wanted_ = false;
  loops_since_optimization_ = 0;
}

// True when poses of before were moved.
bool Localizer::finish_optimization(std::uint32_t stop) {
  if (!due_ || *due_ > stop) return false;
  due_.reset();
  apply(optimizer().fetch());
  return true;
}

void Localizer::apply(const GraphSolution& solution) {
  ++counts_.optimizations;
  const auto taken = new_loops_.begin() + static_cast<std::ptrdiff_t>(started_loops_);
  for (auto loop = new_loops_.begin(); loop != taken; ++loop) graph_.add_edge(*loop);
  new_loops_.erase(new_loops_.begin(), taken);
  started_loops_ = 0;
  if (!solution.summary.usable) {
    ++counts_.failed_optimizations;
    return;
  }
  graph_.move(solution.T_map_robot);
  graph_.remove_edges(solution.outvoted);
  for (const PoseGraphEdge& edge : solution.outvoted) {
    decide(edge, LoopOutcome::kOutvoted, Reason::kNone, 0.0);
    ++counts_.removed_loops;
  }
  const std::size_t solved = solution.covariance.size();
  for (std::size_t i = 0; i < solved; ++i) stops_[i].covariance = solution.covariance[i];
  for (std::size_t i = std::max<std::size_t>(1, solved); i < stops_.size(); ++i) {
    stops_[i].covariance = covariance_in_map(static_cast<std::uint32_t>(i));
  }
  ++version_;
}

// --- the end of a log

void Localizer::finish() {
  if (stops_.size() < 2) return;
  optimize_now();
  // Stops of a stored map were compared with each other when it was made.
  const std::size_t first = std::max<std::size_t>(1, stored_stops_);
  if (first >= stops_.size()) return;
  std::vector<std::uint32_t> again(stops_.size() - first);
  std::iota(again.begin(), again.end(), static_cast<std::uint32_t>(first));
  for (std::uint32_t pass = 0; pass < config_.final_passes; ++pass) {
    if (match_revisits_of(again) == 0) break;
    const std::vector<Pose2> before = graph_.poses();
    optimize_now();
    again = moved_since(before);
  }
}

// Only these can have come near to others.
std::vector<std::uint32_t> Localizer::moved_since(const std::vector<Pose2>& before) const {
  std::vector<std::uint32_t> moved;
  for (std::uint32_t stop = 1; stop < stops_.size(); ++stop) {
    const Correction correction{before[stop], graph_.poses()[stop]};
    if (correction.way_m() > kMoved_m || correction.turn_rad() > kMoved_rad) moved.push_back(stop);
  }
  return moved;
}

// Lets a running optimisation take effect now.
void Localizer::settle() {
  if (!due_) return;
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  due_ = stop;
  finish_optimization(stop);
}

void Localizer::optimize_now() {
  settle();
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  optimization_wanted_ = true;
  start_optimization(stop);
  due_ = stop;
  finish_optimization(stop);
}

// Returns how many loops were closed.
std::size_t Localizer::match_revisits_of(std::span<const std::uint32_t> stops) {
  std::vector<MatchTask> tasks;
  for (const std::uint32_t stop : stops) {
    const std::vector<UncertainPose> relative = graph_.relative_to(stop, searchable_reach());
    for (const Candidate& candidate : candidates(stop, relative, false, config_.revisit_matches)) {
      tasks.push_back(make_task(stop, candidate.id, relative[candidate.id]));
    }
  }
  const std::size_t before = graph_.edges().size() + new_loops_.size();
  pending_.clear();
  for (const Answer& answer : run(tasks, EdgeKind::kRevisit, nullptr)) {
    if (answer.accepted) add_loop(answer);
  }
  return graph_.edges().size() + new_loops_.size() - before;
}

}  // namespace topogeo::localization
