// The part of ThesisLocalizer that closes cycles (7.3.1.2).
#include <algorithm>
#include <cmath>

#include "topogeo/localization/thesis/thesis_localizer.hpp"

namespace topogeo::localization {

using geometry::Pose2;

// Forward and backward in turn: once a cycle has closed, other maps may overlap.
bool ThesisLocalizer::close_cycles(std::uint32_t stop) {
  if (config_.revisit_matches == 0) return false;
  bool moved = false;
  std::vector<std::uint32_t> tried;  // ascending
  for (std::uint32_t round = 0; round < thesis_.alternations; ++round) {
    const std::vector<UncertainPose> relative = graph_.relative_to(stop);
    std::vector<Neighbour> seen = neighbours(stop, graph_.poses()[stop], relative);
    std::vector<std::uint32_t> overlaps;
    overlaps.reserve(seen.size());
    for (const Neighbour& neighbour : seen) overlaps.push_back(neighbour.id);
    stops_[stop].overlaps = overlaps;
    const std::vector<std::uint32_t> fresh =
        newly_seen(overlaps, stops_[stop - 1].overlaps, stop - 1);  // prop. 7.3.2
    std::erase_if(seen, [&](const Neighbour& n) {
      return recent(n.id, stop) || !std::binary_search(fresh.begin(), fresh.end(), n.id) ||
             std::binary_search(tried.begin(), tried.end(), n.id);
    });
    if (seen.empty()) break;
    std::stable_sort(seen.begin(), seen.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.overlap > b.overlap; });
    if (seen.size() > config_.revisit_matches) seen.resize(config_.revisit_matches);
    for (const Neighbour& neighbour : seen) tried.push_back(neighbour.id);
    std::sort(tried.begin(), tried.end());
    if (!close_cycle(stop, seen)) break;
    moved = true;
  }
  // What did not close stays new to the next stop. Else its matches there would pass for forward
  // ones and move the robot away from the poses that it came by.
  const std::vector<std::uint32_t> fresh =
      newly_seen(stops_[stop].overlaps, stops_[stop - 1].overlaps, stop - 1);
  std::erase_if(stops_[stop].overlaps, [&](std::uint32_t id) {
    return !recent(id, stop) && std::binary_search(fresh.begin(), fresh.end(), id) &&
           store_.find(id, stop).empty();
  });
  return moved;
}

bool ThesisLocalizer::close_cycle(std::uint32_t stop, const std::vector<Neighbour>& seen_again) {
  std::vector<Match> matches = match(stop, seen_again, thesis_.cycle_solutions);
  const Pose2 T_map_before = graph_.poses()[stop];
  std::erase_if(matches, [&](const Match& match) {
    if (match.result.verdict == Verdict::kAccepted ||
        match.result.reason == Reason::kSecondSolution) {
      return false;
    }
    decide(stop, match, LoopOutcome::kGate, T_map_before);
    return true;
  });
  if (matches.empty()) return false;
  std::uint32_t first = stop;
  for (const Match& match : matches) {
    first = std::min(first, match.earlier);
    store(stop, match);
  }
  BackwardProblem problem = backward_problem(first, stop);
  problem.candidates = candidates(matches, first);
  ++counts_.optimizations;
  const BackwardResult found = correct_backward(problem, store_, thesis_.backward);
  if (found.outcome != LoopSearchOutcome::kClosed) {
    ++counts_.failed_optimizations;
    for (const Match& match : matches) {
      store_.put(match.earlier, stop, {});
      decide(stop, match, LoopOutcome::kNoClosing, T_map_before);
    }
    return false;
  }
  apply(problem, found.paths.front());
  const std::uint32_t winner = problem.candidates[found.paths.front().candidate].via;
  for (const Match& match : matches) {
    const Pose2 T_map_says = graph_.poses()[match.earlier] * match.T_earlier_new.T_a_b;
    const Eigen::Vector3d off = geometry::difference(T_map_says, graph_.poses()[stop]);
    const bool agrees = off.head<2>().squaredNorm() <=
                            config_.unaided_correction_m * config_.unaided_correction_m &&
                        std::fabs(off.z()) <= config_.unaided_correction_rad;
    decide(stop, match,
           agrees || match.earlier == winner ? LoopOutcome::kAccepted : LoopOutcome::kNoClosing,
           T_map_before);
    if (!agrees) {
      store_.put(match.earlier, stop, {});
      continue;
    }
    closures_.push_back({match.earlier, stop, match.T_earlier_new.T_a_b});
    graph_.add_edge({match.earlier, stop, EdgeKind::kRevisit, match.T_earlier_new.T_a_b,
                     match.T_earlier_new.covariance});
  }
  move(graph_.poses());  // the new edges make the old poses surer
  return true;
}

// All solutions of the last map against the maps seen again, relative to the first pose.
std::vector<BackwardCandidate> ThesisLocalizer::candidates(const std::vector<Match>& matches,
                                                           std::uint32_t first) const {
  const auto last = static_cast<std::uint32_t>(stops_.size() - 1);
  std::vector<BackwardCandidate> found;
  for (const Match& match : matches) {
    const Pose2 T_first_via =
        geometry::between(graph_.poses()[first], graph_.poses()[match.earlier]);
    for (const RelativeSolution& solution : store_.find(match.earlier, last)) {
      found.push_back(
          {match.earlier,
           {T_first_via * solution.T_earlier_later,
            geometry::compose_covariance(T_first_via, Eigen::Matrix3d::Zero(),
                                         solution.T_earlier_later, solution.covariance)},
           solution.fitness});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
  return found;
}

BackwardProblem ThesisLocalizer::backward_problem(std::uint32_t first, std::uint32_t stop) const {
  BackwardProblem problem;
  problem.first_id = first;
  const std::vector<Pose2>& poses = graph_.poses();
  const std::vector<UncertainPose> relative = graph_.relative_to(first);
  for (std::uint32_t i = first; i <= stop; ++i) {
    BackwardPose& pose = problem.poses.emplace_back();
    pose.view = stops_[i].view;
    if (i == first) continue;
    pose.T_first_this = relative[i];
    pose.T_previous_this = stops_[i].T_previous_this;
    for (const std::uint32_t earlier : stops_[i].overlaps) {
      const Pose2 T_earlier_this = geometry::between(poses[earlier], poses[i]);
      if (overlap(seen_from(stops_[i].view, T_earlier_this, Eigen::Vector3d::Zero()),
                  stops_[earlier].view)) {
        pose.overlaps.push_back(earlier);
      }
    }
  }
  return problem;
}

// The corrected poses, and the step that each was given as the first of the stored solutions, so
// that the next walk back starts from what this one found.
void ThesisLocalizer::apply(const BackwardProblem& problem, const LoopPath& way) {
  const std::uint32_t first = problem.first_id;
  std::vector<Pose2> poses = graph_.poses();
  for (std::uint32_t k = 1; k < way.T_first_pose.size(); ++k) {
    poses[first + k] = poses[first] * way.T_first_pose[k];
  }
  for (std::uint32_t id = first + 1; id < first + way.T_first_pose.size(); ++id) {
    const auto known = store_.find(id - 1, id);
    if (known.empty()) continue;
    std::vector<RelativeSolution> solutions(known.begin(), known.end());
    solutions.front().T_earlier_later = geometry::between(poses[id - 1], poses[id]);
    store_.put(id - 1, id, std::move(solutions));
  }
  move(poses);
}

// The graph anew with other poses; its edges say how well neighbours know each other, which has not
// changed.
void ThesisLocalizer::move(const std::vector<Pose2>& T_map_robot) {
  PoseGraph moved;
  for (const Pose2& pose : T_map_robot) moved.add_pose(pose);
  for (const PoseGraphEdge& edge : graph_.edges()) moved.add_edge(edge);
  graph_ = std::move(moved);
  const std::vector<UncertainPose> relative = graph_.relative_to(0);
  for (std::size_t i = 1; i < stops_.size(); ++i) stops_[i].covariance = relative[i].covariance;
  ++version_;
}

void ThesisLocalizer::decide(std::uint32_t stop, const Match& match, LoopOutcome outcome,
                             const Pose2& T_map_before) {
  LoopDecision decision;
  decision.step = stop;
  decision.earlier_id = match.earlier;
  decision.later_id = stop;
  decision.outcome = outcome;
  decision.reason = match.result.reason;
  decision.fitness = match.result.fitness;
  decision.T_earlier_later = match.T_earlier_new.T_a_b;
  if (match.result.status == MatchStatus::kSolved) {
    const Pose2 T_map_says = graph_.poses()[match.earlier] * match.T_earlier_new.T_a_b;
    const Eigen::Vector3d off = geometry::difference(T_map_says, T_map_before);
    decision.correction_m = std::sqrt(off.head<2>().squaredNorm());
    decision.correction_rad = std::fabs(off.z());
  } else {
    decision.T_earlier_later = geometry::between(graph_.poses()[match.earlier], T_map_before);
  }
  decisions_.push_back(decision);
}

}  // namespace topogeo::localization
