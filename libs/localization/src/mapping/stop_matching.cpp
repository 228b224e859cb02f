#include "topogeo/localization/mapping/stop_matching.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/LU>

#include "topogeo/localization/mapping/search_space.hpp"
#include "topogeo/localization/matching/expected_overlap.hpp"
#include "topogeo/localization/matching/refinement.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

// Further apart, two stops hardly see anything in common. Checked first, because most stops of a
// long log are far away.
constexpr double kFarthestCompared_m = 20.0;
constexpr double kWidening =
    3.0;  // of the deviations, when nothing was found where odometry predicts

bool any_accepted(std::span<const StopMatch> matches) {
  return std::any_of(matches.begin(), matches.end(),
                     [](const StopMatch& match) { return match.accepted(); });
}

}  // namespace

StopMatching::StopMatching(const LocalizerConfig& config, MatchPool& pool)
    : config_(config), requests_(config, pool) {}

void StopMatching::add(std::shared_ptr<const LocalMap> map, double distance_m) {
  requests_.add_map(map);
  Stop stop;
  MatchFeatures features = extract_scan_features(map->points, map->T_robot_laser);
  stop.profile = std::move(features.profile);
  stop.outline = outline_of(features.coarse);
  stop.path_m = stops_.empty() ? 0.0 : stops_.back().path_m + distance_m;
  stop.map = std::move(map);
  stops_.push_back(std::move(stop));
}

void StopMatching::skip(const PoseGraphEdge& known) {
  comparisons_.record(known.from, known.to, geometry::inverse(known.T_from_to), true);
}

// Stops from this one on are recent.
std::uint32_t StopMatching::first_recent(std::uint32_t stop) const {
  std::uint32_t first = stop;
  while (first > 0 && path_m(stop) - path_m(first - 1) <= config_.recent_way_m) --first;
  return first;
}

void StopMatching::consider(CandidateChoice& choice, const PoseGraph& graph, std::uint32_t earlier,
                            std::uint32_t stop, const UncertainPose& T_stop_earlier) const {
  const std::vector<Pose2>& poses = graph.poses();
  const Eigen::Vector2d apart_m = poses[earlier].position_m() - poses[stop].position_m();
  if (apart_m.squaredNorm() > kFarthestCompared_m * kFarthestCompared_m) return;
  if (!searchable(config_, T_stop_earlier)) return;
  if (!comparisons_.worth(earlier, stop, T_stop_earlier.T_a_b)) return;
  choice.consider(earlier, stops_[stop].profile, stops_[earlier].outline, T_stop_earlier);
}

std::vector<MatchCandidate> StopMatching::recent_candidates(
    const PoseGraph& graph, std::span<const UncertainPose> relative) const {
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  const std::uint32_t first = first_recent(stop);
  CandidateChoice choice(config_.smallest_expected_overlap);
  for (std::uint32_t i = first; i + 1 < stop; ++i) {
    consider(choice, graph, i, stop, relative[i]);
  }
  // The stop just before is worth a task in any case, however bad odometry is by now.
  if (first < stop) choice.take(stop - 1);
  return choice.best(config_.recent_matches);
}

std::vector<MatchCandidate> StopMatching::revisited_candidates(
    const PoseGraph& graph, std::uint32_t stop, std::span<const UncertainPose> relative) const {
  const std::uint32_t first = first_recent(stop);
  CandidateChoice choice(config_.smallest_expected_overlap);
  for (std::uint32_t i = 0; i < first; ++i) {
    consider(choice, graph, i, stop, relative[i]);
  }
  return choice.best_apart(config_.revisit_matches);
}

std::vector<StopMatch> StopMatching::match_recent(const PoseGraph& graph) {
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  const std::vector<UncertainPose> relative =
      graph.relative_to(stop, {first_recent(stop), PoseGraph::kUnlimited});
  std::map<std::uint32_t, std::vector<MatchSolution>> solutions;
  const auto matches_within = [&](double widening) {
    std::vector<StopMatch> found =
        run(recent_tasks(graph, relative, widening), EdgeKind::kSequential);
    for (const StopMatch& match : found) solutions[match.edge.from] = match.solutions;
    return found;
  };
  std::vector<StopMatch> matches = matches_within(1.0);
  if (!any_accepted(matches)) {
    std::vector<StopMatch> wider = matches_within(kWidening);
    if (any_accepted(wider)) matches = std::move(wider);
  }
  last_solutions_ = std::move(solutions);
  return matches;
}

std::vector<MatchTask> StopMatching::recent_tasks(const PoseGraph& graph,
                                                  std::span<const UncertainPose> relative,
                                                  double widening) {
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  const Pose2 T_previous_robot = stops_[stop].map->T_previous_robot;
  std::vector<MatchTask> tasks;
  for (const MatchCandidate& candidate : recent_candidates(graph, relative)) {
    UncertainPose prior = relative[candidate.id];
    prior.covariance *= widening * widening;
    MatchTask task = requests_.make(stop, candidate.id, prior);
    const Pose2 T_candidate_previous =
        geometry::between(graph.poses()[candidate.id], graph.poses()[stop - 1]);
    task.initial_individuals.push_back(geometry::inverse(T_candidate_previous * T_previous_robot));
    for (const MatchSolution& solution : last_solutions_[candidate.id]) {
      task.initial_individuals.push_back(geometry::inverse(T_previous_robot) *
                                         solution.T_reference_query);
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

std::vector<StopMatch> StopMatching::match_revisited(const PoseGraph& graph,
                                                     std::span<const std::uint32_t> stops) {
  const PoseGraph::Reach reach{0, largest_searchable_cost(config_)};
  std::vector<MatchTask> tasks;
  for (const std::uint32_t stop : stops) {
    const std::vector<UncertainPose> relative = graph.relative_to(stop, reach);
    for (const MatchCandidate& candidate : revisited_candidates(graph, stop, relative)) {
      tasks.push_back(requests_.make(stop, candidate.id, relative[candidate.id]));
    }
  }
  return run(tasks, EdgeKind::kRevisit);
}

std::vector<StopMatch> StopMatching::run(std::span<const MatchTask> tasks, EdgeKind kind) {
  const std::vector<MatchResult> results = requests_.run(tasks);
  std::vector<StopMatch> matches;
  matches.reserve(results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    matches.push_back(judged(tasks[i], results[i], kind));
    comparisons_.record(tasks[i].query_map_id, tasks[i].reference_map_id,
                        tasks[i].T_reference_query, matches.back().accepted());
  }
  return matches;
}

StopMatch StopMatching::judged(const MatchTask& task, const MatchResult& result,
                               EdgeKind kind) const {
  const double foreseen =
      expected_overlap(stops_[task.reference_map_id].profile, stops_[task.query_map_id].outline,
                       {task.T_reference_query, task.covariance});
  const Pose2 T_later_earlier =
      result.status == MatchStatus::kSolved
          ? without_prior(result.T_reference_query, result.covariance,
                          {task.T_reference_query, task.covariance.inverse()})
          : task.T_reference_query;
  StopMatch match;
  match.edge = {task.query_map_id, task.reference_map_id, kind, geometry::inverse(T_later_earlier),
                geometry::inverse_covariance(T_later_earlier, result.covariance)};
  match.verdict = result.verdict;
  match.reason = result.reason;
  match.fitness = result.fitness;
  match.evidence = step_match(task, result, foreseen, task.query_map_id);
  match.solutions = result.solutions;
  return match;
}

}  // namespace topogeo::localization
