#include "topogeo/thesis/cycle_closing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

std::uint32_t last_of(const ThesisMap& map) {
  return static_cast<std::uint32_t>(map.size() - 1);
}

// Proposition 7.3.2: maps that the last stop overlaps with and the previous stop did not.
std::vector<std::uint32_t> fresh_overlaps(const ThesisMap& map) {
  const std::uint32_t stop = last_of(map);
  return topomap::newly_seen(map.stop(stop).overlaps, map.stop(stop - 1).overlaps, stop - 1);
}

// All solutions of the last map against the maps seen again, relative to the first pose.
std::vector<BackwardCandidate> candidates_of(const ThesisMap& map, const SolutionStore& solutions,
                                             std::span<const ThesisMatch> matches,
                                             std::uint32_t first) {
  std::vector<BackwardCandidate> found;
  for (const ThesisMatch& match : matches) {
    const Pose2 T_first_via = geometry::between(map.poses()[first], map.poses()[match.earlier]);
    for (const RelativeSolution& solution : solutions.find(match.earlier, last_of(map))) {
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

// The fittest of the candidates, without those at a pose that a fitter one already has.
std::vector<BackwardCandidate> distinct_candidates(std::vector<BackwardCandidate> candidates,
                                                   const ThesisSlamConfig& config) {
  std::vector<BackwardCandidate> distinct;
  for (BackwardCandidate& candidate : candidates) {
    if (distinct.size() == config.thesis.cycle_candidates) break;
    const bool known = std::ranges::any_of(distinct, [&](const BackwardCandidate& fitter) {
      const Eigen::Vector3d off =
          geometry::difference(fitter.T_first_last.T_a_b, candidate.T_first_last.T_a_b);
      return off.head<2>().norm() < 1.5 * config.genetic.resolution_m &&
             std::fabs(off.z()) < 1.5 * config.genetic.resolution_rad;
    });
    if (!known) distinct.push_back(std::move(candidate));
  }
  return distinct;
}

// The loop from a stop to the last one by the forward correction.
BackwardProblem backward_problem(const ThesisMap& map, std::uint32_t first) {
  BackwardProblem problem;
  problem.first_id = first;
  const std::vector<UncertainPose> relative = map.relative_to(first);
  for (std::uint32_t i = first; i < map.size(); ++i) {
    BackwardPose& pose = problem.poses.emplace_back();
    pose.view = map.stop(i).view;
    if (i == first) continue;
    pose.T_first_this = relative[i];
    pose.T_previous_this = map.stop(i).T_previous_this;
    for (const std::uint32_t earlier : map.stop(i).overlaps) {
      if (map.overlap_now(earlier, i)) pose.overlaps.push_back(earlier);
    }
  }
  return problem;
}

// Applies the corrected poses. The step to each becomes the first of the stored solutions, so that
// the next correction starts from this result.
void apply_path(ThesisMap& map, std::uint32_t first, const LoopPath& path) {
  std::vector<Pose2> poses = map.poses();
  for (std::uint32_t k = 1; k < path.T_first_pose.size(); ++k) {
    poses[first + k] = poses[first] * path.T_first_pose[k];
  }
  for (std::uint32_t id = first + 1; id < first + path.T_first_pose.size(); ++id) {
    const auto known = map.solutions().find(id - 1, id);
    if (known.empty()) continue;
    std::vector<RelativeSolution> solutions(known.begin(), known.end());
    solutions.front().T_earlier_later = geometry::between(poses[id - 1], poses[id]);
    map.solutions().put(id - 1, id, std::move(solutions));
  }
  map.move(poses);
}

}  // namespace

bool CycleClosing::close(ThesisMap& map, ThesisMatching& matching) {
  if (config_.revisit_matches == 0) return false;
  const std::uint32_t stop = last_of(map);
  bool moved = false;
  std::vector<std::uint32_t> tried;  // ascending
  for (std::uint32_t round = 0; round < config_.thesis.alternations; ++round) {
    const std::vector<ThesisNeighbour> seen = seen_again(map, tried);
    if (seen.empty()) break;
    for (const ThesisNeighbour& neighbour : seen) tried.push_back(neighbour.id);
    std::sort(tried.begin(), tried.end());
    if (!close_with(map, matching, seen)) break;
    moved = true;
  }
  // Maps that did not close a cycle stay new for the next stop. Otherwise its matches with them
  // would pass for forward ones and move the robot away from its path.
  const std::vector<std::uint32_t> fresh = fresh_overlaps(map);
  std::vector<std::uint32_t> overlaps = map.stop(stop).overlaps;
  std::erase_if(overlaps, [&](std::uint32_t id) {
    return !map.recent(id, stop) && std::binary_search(fresh.begin(), fresh.end(), id) &&
           map.solutions().find(id, stop).empty();
  });
  map.set_overlaps(stop, std::move(overlaps));
  return moved;
}

// The maps that the last stop overlaps with at its current pose and that close a cycle, best first;
// updates its overlaps.
std::vector<ThesisNeighbour> CycleClosing::seen_again(ThesisMap& map,
                                                      std::span<const std::uint32_t> tried) const {
  const std::uint32_t stop = last_of(map);
  std::vector<ThesisNeighbour> seen =
      map.neighbours(stop, map.poses()[stop], map.relative_to(stop));
  std::vector<std::uint32_t> overlaps;
  overlaps.reserve(seen.size());
  for (const ThesisNeighbour& neighbour : seen) overlaps.push_back(neighbour.id);
  map.set_overlaps(stop, std::move(overlaps));
  const std::vector<std::uint32_t> fresh = fresh_overlaps(map);
  std::erase_if(seen, [&](const ThesisNeighbour& n) {
    return map.recent(n.id, stop) || !std::binary_search(fresh.begin(), fresh.end(), n.id) ||
           std::binary_search(tried.begin(), tried.end(), n.id);
  });
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.overlap > b.overlap; });
  if (seen.size() > config_.revisit_matches) seen.resize(config_.revisit_matches);
  return seen;
}

std::vector<CycleSolution> CycleClosing::solutions(const ThesisMap& map, ThesisMatching& matching) {
  const std::uint32_t stop = last_of(map);
  std::vector<ThesisNeighbour> seen =
      map.neighbours(stop, map.poses()[stop], map.relative_to(stop));
  std::erase_if(seen, [&](const ThesisNeighbour& n) { return map.recent(n.id, stop); });
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.overlap > b.overlap; });
  if (seen.size() > config_.revisit_matches) seen.resize(config_.revisit_matches);
  std::vector<CycleSolution> found;
  if (seen.empty()) return found;
  std::uint32_t first = stop;
  SolutionStore known = map.solutions();
  std::vector<ThesisMatch> matches = matching.match(map, seen, config_.thesis.cycle_solutions);
  std::erase_if(matches, [&](const ThesisMatch& match) {
    if (match.result.verdict == Verdict::kAccepted ||
        match.result.reason == Reason::kSecondSolution) {
      return false;
    }
    decide(map, match, LoopOutcome::kGate, map.poses()[stop]);
    return true;
  });
  if (matches.empty()) return found;
  for (const ThesisMatch& match : matches) {
    first = std::min(first, match.earlier);
    map.store_in(known, stop, match);
  }
  BackwardProblem problem = backward_problem(map, first);
  std::vector<std::uint32_t> closed;
  for (const BackwardCandidate& candidate :
       distinct_candidates(candidates_of(map, known, matches, first), config_)) {
    problem.candidates = {candidate};
    ++attempts_;
    const BackwardResult result =
        correct_backward(problem, map.solutions(), config_.thesis.backward);
    if (result.outcome != LoopSearchOutcome::kClosed) {
      ++failures_;
      continue;
    }
    closed.push_back(candidate.via);
    CycleSolution& solution = found.emplace_back();
    solution.earlier = candidate.via;
    solution.later = stop;
    solution.T_map_stop.assign(map.poses().begin(), map.poses().begin() + first + 1);
    const LoopPath& path = result.paths.front();
    for (std::size_t k = 1; k < path.T_first_pose.size(); ++k) {
      solution.T_map_stop.push_back(map.poses()[first] * path.T_first_pose[k]);
    }
  }
  for (const ThesisMatch& match : matches) {
    const bool used = std::ranges::find(closed, match.earlier) != closed.end();
    decide(map, match, used ? LoopOutcome::kAccepted : LoopOutcome::kNoClosing, map.poses()[stop]);
  }
  return found;
}

bool CycleClosing::close_with(ThesisMap& map, ThesisMatching& matching,
                              std::span<const ThesisNeighbour> seen_again) {
  const std::uint32_t stop = last_of(map);
  std::vector<ThesisMatch> matches =
      matching.match(map, seen_again, config_.thesis.cycle_solutions);
  const Pose2 T_map_before = map.poses()[stop];
  std::erase_if(matches, [&](const ThesisMatch& match) {
    if (match.result.verdict == Verdict::kAccepted ||
        match.result.reason == Reason::kSecondSolution) {
      return false;
    }
    decide(map, match, LoopOutcome::kGate, T_map_before);
    return true;
  });
  if (matches.empty()) return false;
  std::uint32_t first = stop;
  for (const ThesisMatch& match : matches) {
    first = std::min(first, match.earlier);
    map.store(stop, match);
  }
  BackwardProblem problem = backward_problem(map, first);
  problem.candidates = candidates_of(map, map.solutions(), matches, first);
  ++attempts_;
  BackwardResult found = correct_backward(problem, map.solutions(), config_.thesis.backward);
  if (found.outcome != LoopSearchOutcome::kClosed) {
    ++failures_;
    for (const ThesisMatch& match : matches) {
      map.solutions().put(match.earlier, stop, {});
      decide(map, match, LoopOutcome::kNoClosing, T_map_before);
    }
    return false;
  }
  apply_path(map, first, found.paths.front());
  accept(map, matches, problem.candidates[found.paths.front().candidate].via, T_map_before);
  last_closing_ = ClosedCycle{std::move(problem), std::move(found)};
  return true;
}

// Keeps the matches that agree with the corrected poses. `winner`: the map whose candidate won.
void CycleClosing::accept(ThesisMap& map, std::span<const ThesisMatch> matches,
                          std::uint32_t winner, const Pose2& T_map_before) {
  const std::uint32_t stop = last_of(map);
  for (const ThesisMatch& match : matches) {
    const Pose2 T_map_measured = map.poses()[match.earlier] * match.T_earlier_new.T_a_b;
    const Eigen::Vector3d off = geometry::difference(T_map_measured, map.poses()[stop]);
    const bool agrees = off.head<2>().squaredNorm() <=
                            config_.unaided_correction_m * config_.unaided_correction_m &&
                        std::fabs(off.z()) <= config_.unaided_correction_rad;
    decide(map, match,
           agrees || match.earlier == winner ? LoopOutcome::kAccepted : LoopOutcome::kNoClosing,
           T_map_before);
    if (!agrees) {
      map.solutions().put(match.earlier, stop, {});
      continue;
    }
    closures_.push_back({match.earlier, stop, match.T_earlier_new.T_a_b});
    map.add_closure(stop, match);
  }
  map.move(std::vector<Pose2>(map.poses()));  // the new edges reduce covariances
}

void CycleClosing::decide(const ThesisMap& map, const ThesisMatch& match, LoopOutcome outcome,
                          const Pose2& T_map_before) {
  LoopDecision decision;
  decision.step = last_of(map);
  decision.earlier_id = match.earlier;
  decision.later_id = last_of(map);
  decision.outcome = outcome;
  decision.reason = match.result.reason;
  decision.fitness = match.result.fitness;
  decision.T_earlier_later = match.T_earlier_new.T_a_b;
  if (match.result.status == MatchStatus::kSolved) {
    const Pose2 T_map_measured = map.poses()[match.earlier] * match.T_earlier_new.T_a_b;
    const Eigen::Vector3d off = geometry::difference(T_map_measured, T_map_before);
    decision.correction_m = std::sqrt(off.head<2>().squaredNorm());
    decision.correction_rad = std::fabs(off.z());
  } else {
    decision.T_earlier_later = geometry::between(map.poses()[match.earlier], T_map_before);
  }
  decisions_.push_back(decision);
}

}  // namespace topogeo::localization
