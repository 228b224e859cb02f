#include "stop_matching.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/LU>

#include "topogeo/matching/expected_overlap.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/slam/match_requests.hpp"

#include "window_match.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

// Stops further apart have hardly anything in common. Checked first, because most stops of a long
// log are far away.
constexpr double kFarthestCompared_m = 20.0;
// The nearest stops show a place well enough, however often it was passed.
constexpr std::size_t kMostConsidered = 100;
// Drift between two closed loops is never larger, so places further away are not searched.
constexpr double kFarthestPlace_m = 100.0;
constexpr double kWidening = 3.0;  // of the deviations, if no match was found within the prediction

// Path between two queries for places.
constexpr double kBetweenQueries_m = 1.0;
// Path along which predictions stay right after a match by prediction.
constexpr double kRevisitHolds_m = 3.0;
// Accuracy of the coarse search.
constexpr double kPlaceSigma_m = 0.25;
constexpr double kPlaceSigma_rad = 0.06;
constexpr double kLeastPlaceValue = 0.6;
// Tasks of a query: a right place is among the best ones, or the next queries find it.
constexpr std::size_t kPlacesCompared = 3;
constexpr std::size_t kStopsOfPlace = 2;
// With better predictions no place is searched, unless this many successive stops contradicted
// theirs.
constexpr double kWellKnown_m = 0.25;
constexpr std::uint32_t kMisfits = 2;
constexpr std::size_t kStopsOfQuery = 3;
constexpr double kBetweenStops_m = 1.5;
constexpr double kQueryLength_m = 5.0;

}  // namespace

StopMatching::StopMatching(const LocalizerConfig& config, MatchPool& pool)
    : config_(config), requests_(config, pool) {}

void StopMatching::add(std::shared_ptr<const LocalMap> map, double distance_m) {
  requests_.add_map(map);
  auto view = std::make_shared<const StopView>(
      view_of(extract_scan_features(points_for(*map, config_.evidence), map->T_robot_laser)));
  path_m_.push_back(stops_.empty() ? 0.0 : path_m_.back() + distance_m);
  places_.add(view, path_m_.back());
  stops_.push_back({std::move(map), std::move(view)});
}

void StopMatching::skip(const PoseGraphEdge& known) {
  comparisons_.record(known.from, known.to, geometry::inverse(known.T_from_to), true);
}

// The first stop that is recent for `stop`.
std::uint32_t StopMatching::first_recent(std::uint32_t stop) const {
  std::uint32_t first = stop;
  while (first > 0 && path_m(stop) - path_m(first - 1) <= config_.recent_way_m) --first;
  return first;
}

void StopMatching::consider(CandidateChoice& choice, const PoseGraph& graph, std::uint32_t earlier,
                            std::uint32_t stop, const UncertainPose& T_stop_earlier,
                            bool common) const {
  const std::vector<Pose2>& poses = graph.poses();
  const Eigen::Vector2d apart_m = poses[earlier].position_m() - poses[stop].position_m();
  if (apart_m.squaredNorm() > kFarthestCompared_m * kFarthestCompared_m) return;
  if (!searchable(config_, T_stop_earlier)) return;
  if (!comparisons_.worth(earlier, stop, T_stop_earlier.T_a_b)) return;
  const StopView& viewer = *stops_[stop].view;
  const StopView& seen = *stops_[earlier].view;
  if (common) {
    choice.consider_common(earlier, viewer.profile, seen.outline, T_stop_earlier);
  } else {
    choice.consider(earlier, viewer.profile, seen.outline, T_stop_earlier);
  }
}

std::vector<MatchCandidate> StopMatching::recent_candidates(const PoseGraph& graph,
                                                            const RelativePoses& relative) const {
  const std::uint32_t stop = last_stop();
  const std::uint32_t first = first_recent(stop);
  CandidateChoice choice(config_.smallest_expected_overlap);
  for (std::uint32_t i = first; i + 1 < stop; ++i) {
    consider(choice, graph, i, stop, relative.at(i), false);
  }
  // The previous stop is worth a task in any case, however bad odometry is by now.
  if (first < stop) choice.take(stop - 1);
  return choice.best(config_.recent_matches);
}

CandidateChoice StopMatching::shown_if_right(std::span<const std::uint32_t> candidates,
                                             const RelativePoses& relative) const {
  CandidateChoice choice(config_.smallest_expected_overlap);
  for (const std::uint32_t earlier : candidates) {
    const UncertainPose* T_stop_earlier = relative.find(earlier);
    if (T_stop_earlier == nullptr) continue;
    choice.consider(earlier, stops_.back().view->profile, stops_[earlier].view->outline,
                    {T_stop_earlier->T_a_b, Eigen::Matrix3d::Zero()});
  }
  return choice;
}

std::vector<MatchCandidate> StopMatching::revisited_candidates(
    const PoseGraph& graph, std::uint32_t stop, std::span<const std::uint32_t> candidates,
    const RelativePoses& relative) const {
  CandidateChoice choice(config_.smallest_expected_overlap);
  for (const std::uint32_t earlier : candidates) {
    const UncertainPose* T_stop_earlier = relative.find(earlier);
    if (T_stop_earlier != nullptr) consider(choice, graph, earlier, stop, *T_stop_earlier, true);
  }
  return choice.best_apart(config_.revisit_matches);
}

std::vector<std::uint32_t> StopMatching::recent_stops() const {
  std::vector<std::uint32_t> recent(last_stop() - first_recent(last_stop()));
  std::iota(recent.begin(), recent.end(), first_recent(last_stop()));
  return recent;
}

std::vector<StopMatch> StopMatching::match_recent(const PoseGraph& graph) {
  const RelativePoses relative = graph.relative_to(last_stop(), recent_stops());
  std::map<std::uint32_t, std::vector<MatchSolution>> solutions;
  const auto matches_within = [&](double widening) {
    // Chosen again each time: a pair just compared without success is not worth a second try.
    const std::vector<MatchCandidate> candidates = recent_candidates(graph, relative);
    std::vector<StopMatch> found =
        run(recent_tasks(graph, relative, candidates, widening), EdgeKind::kSequential);
    for (const StopMatch& match : found) solutions[match.edge.from] = match.solutions;
    return found;
  };
  std::vector<StopMatch> matches = matches_within(1.0);
  if (!any_accepted(matches)) {
    std::vector<StopMatch> wider = matches_within(kWidening);
    if (any_accepted(wider)) {
      matches = std::move(wider);
      for (StopMatch& match : matches) match.widened = true;
    }
  }
  last_solutions_ = std::move(solutions);
  calibrate(matches);
  return matches;
}

std::vector<StopMatch> StopMatching::match_unsearchable(const PoseGraph& graph) {
  const std::uint32_t stop = last_stop();
  std::vector<std::uint32_t> near = recent_stops();
  if (near.empty()) near.push_back(stop - 1);
  RelativePoses relative = graph.relative_to(stop, near);
  near.pop_back();  // the previous stop is compared in any case
  const auto found_by_odometry = [&](std::uint32_t earlier) {
    return searchable(config_, relative.at(earlier));
  };
  if (std::ranges::any_of(near, found_by_odometry)) return {};
  std::vector<MatchCandidate> candidates =
      shown_if_right(near, relative).best(config_.recent_matches);
  if (candidates.empty() && !searchable(config_, relative.at(stop - 1))) {
    // The robot may be returning to an earlier place.
    near = graph.stops_near(graph.poses()[stop].position_m(), kFarthestCompared_m, kMostConsidered,
                            first_recent(stop));
    relative = graph.predict_from(stop, near, PoseGraph::kUnlimited, PoseGraph::kMostVisited);
    candidates = shown_if_right(near, relative).best_apart(config_.recent_matches);
  }
  std::vector<StopMatch> matches =
      run(recent_tasks(graph, relative, candidates, 1.0), EdgeKind::kSequential);
  for (StopMatch& match : matches) match.widened = true;
  calibrate(matches);
  return matches;
}

// Uses triangles of the last stop with two recent ones that were matched with each other.
void StopMatching::calibrate(std::span<const StopMatch> matches) {
  const std::uint32_t last = last_stop();
  for (const StopMatch& match : matches) {
    if (match.accepted()) recent_[{match.edge.from, last}] = match.T_later_earlier;
  }
  for (const StopMatch& far : matches) {
    for (const StopMatch& near : matches) {
      if (!far.accepted() || !near.accepted() || far.edge.from >= near.edge.from) continue;
      const auto between = recent_.find({far.edge.from, near.edge.from});
      if (between == recent_.end()) continue;
      calibration_.add_triangle(far.T_later_earlier, near.T_later_earlier, between->second);
    }
  }
  const std::uint32_t first = first_recent(last);
  std::erase_if(recent_, [&](const auto& entry) { return entry.first.first < first; });
}

std::vector<MatchTask> StopMatching::recent_tasks(const PoseGraph& graph,
                                                  const RelativePoses& relative,
                                                  std::span<const MatchCandidate> candidates,
                                                  double widening) {
  const std::uint32_t stop = last_stop();
  // Scan tracking, or odometry if scan points must not count.
  const Pose2 T_previous_robot =
      config_.evidence == MatchEvidence::kScan
          ? stops_[stop].map->T_previous_robot
          : geometry::between(graph.poses()[stop - 1], graph.poses()[stop]);
  std::vector<MatchTask> tasks;
  for (const MatchCandidate& candidate : candidates) {
    UncertainPose prior = relative.at(candidate.id);
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

// Near stops that were matched at their prediction, predictions are right; elsewhere the
// surrounding places are queried now and then.
bool StopMatching::wants_places(std::uint32_t stop) const {
  if (config_.revisit_matches == 0) return false;
  const auto near = [&](const std::set<std::uint32_t>& stops, double distance_m) {
    const auto after = stops.upper_bound(stop);
    return (after != stops.begin() && path_m_[stop] - path_m_[*std::prev(after)] < distance_m) ||
           (after != stops.end() && path_m_[*after] - path_m_[stop] < distance_m);
  };
  return !near(revisited_, kRevisitHolds_m) && !near(recognized_, kBetweenQueries_m);
}

std::vector<StopMatch> StopMatching::match_revisited(const PoseGraph& graph,
                                                     std::span<const std::uint32_t> stops) {
  std::vector<Comparison> comparisons;
  recognized_.clear();
  if (stops.size() == 1 && recognized_last_) recognized_.insert(*recognized_last_);
  for (const std::uint32_t stop : stops) {
    const bool ask = wants_places(stop);
    const Eigen::Vector2d place_m = graph.poses()[stop].position_m();
    const std::vector<std::uint32_t> near =
        graph.stops_near(place_m, kFarthestCompared_m, kMostConsidered, first_recent(stop));
    RelativePoses relative =
        ask ? graph.predict_from(stop, graph.stops_near(place_m, kFarthestPlace_m, stop, stop),
                                 PoseGraph::kUnlimited, PoseGraph::kMostVisited)
            : graph.predict_from(stop, near, largest_searchable_cost(config_),
                                 PoseGraph::kMostVisited);
    relative.widen(map_noise());
    for (const MatchCandidate& candidate : revisited_candidates(graph, stop, near, relative)) {
      const UncertainPose& T_stop_earlier = relative.at(candidate.id);
      comparisons.push_back({requests_.make(stop, candidate.id, T_stop_earlier), T_stop_earlier,
                             ProposalSource::kPrediction});
    }
    if (!ask) continue;
    recognized_.insert(stop);
    recognized_last_ = stop;
    for (Comparison& comparison :
         comparisons_with_places(graph, stop, relative.by_id(graph.poses().size()))) {
      comparisons.push_back(std::move(comparison));
    }
  }
  std::vector<MatchTask> tasks;
  tasks.reserve(comparisons.size());
  for (const Comparison& comparison : comparisons) tasks.push_back(comparison.task);
  std::vector<StopMatch> matches = run(tasks, EdgeKind::kRevisit);
  bool any_predicted = false;
  bool any_plausible = false;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    matches[i].predicted = inverse(comparisons[i].T_later_earlier);
    matches[i].source = comparisons[i].source;
    if (matches[i].accepted() && matches[i].source == ProposalSource::kPrediction) {
      revisited_.insert(matches[i].edge.to);
    }
    any_predicted |= matches[i].source == ProposalSource::kPrediction;
    any_plausible |= matches[i].plausible();
  }
  matches.insert(matches.end(), windows_.begin(), windows_.end());
  windows_.clear();
  if (any_plausible) misfits_ = 0;
  if (any_predicted && !any_plausible && stops.size() == 1) ++misfits_;
  return matches;
}

// Compares the stop, and some before it along the same places, with the stops of those places that
// should have most of their view in common.
std::vector<StopMatching::Comparison> StopMatching::comparisons_with_places(
    const PoseGraph& graph, std::uint32_t stop, std::span<const UncertainPose> relative) {
  std::vector<std::uint32_t> later{stop};
  for (std::uint32_t i = stop; i-- > 0 && later.size() < kStopsOfQuery;) {
    if (path_m_[stop] - path_m_[i] > kQueryLength_m) break;
    if (path_m_[later.back()] - path_m_[i] >= kBetweenStops_m) later.push_back(i);
  }
  std::vector<Comparison> found;
  const Eigen::Matrix3d spread =
      Eigen::Vector3d(kPlaceSigma_m * kPlaceSigma_m, kPlaceSigma_m * kPlaceSigma_m,
                      kPlaceSigma_rad * kPlaceSigma_rad)
          .asDiagonal();
  const std::vector<Pose2>& poses = graph.poses();
  std::set<std::pair<std::uint32_t, std::uint32_t>> chosen;
  std::size_t places = 0;
  for (const PlaceProposal& place : places_.propose(graph, stop, first_recent(stop), relative,
                                                    misfits_ < kMisfits ? kWellKnown_m : 0.0)) {
    if (place.value < kLeastPlaceValue || places == kPlacesCompared) break;
    bool any = false;
    if (!place.aligned.covariance.isZero(0.0)) {
      windows_.push_back(window_match(graph, stop, place, calibration_));
    }
    for (const std::uint32_t query : later) {
      CandidateChoice choice(config_.smallest_expected_overlap);
      const Pose2 T_query_anchor =
          geometry::inverse(place.T_anchor_robot * geometry::between(poses[stop], poses[query]));
      const auto predicted = [&](std::uint32_t earlier) {
        return UncertainPose{
            T_query_anchor * geometry::between(poses[place.anchor], poses[earlier]), spread};
      };
      for (std::uint32_t earlier = place.first_stop; earlier <= place.last_stop; ++earlier) {
        const UncertainPose T_query_earlier = predicted(earlier);
        if (earlier >= first_recent(query) || relative[earlier].covariance.isZero(0.0) ||
            chosen.count({earlier, query}) > 0 ||
            !comparisons_.worth(earlier, query, T_query_earlier.T_a_b)) {
          continue;
        }
        choice.consider_common(earlier, stops_[query].view->profile, stops_[earlier].view->outline,
                               {T_query_earlier.T_a_b, 0.25 * spread});
      }
      for (const MatchCandidate& candidate :
           choice.best_apart(query == stop ? kStopsOfPlace : std::size_t{1})) {
        any = true;
        chosen.insert({candidate.id, query});
        // The prediction of the graph for a stop a little before the queried one.
        const UncertainPose T_query_earlier{geometry::between(poses[query], poses[candidate.id]),
                                            relative[candidate.id].covariance};
        found.push_back({requests_.make(query, candidate.id, predicted(candidate.id)),
                         T_query_earlier, ProposalSource::kPlace});
      }
    }
    if (any) ++places;
  }
  return found;
}

std::vector<StopMatch> StopMatching::run(std::span<const MatchTask> tasks, EdgeKind kind) {
  const std::vector<MatchResult> results = requests_.run(tasks);
  std::vector<StopMatch> matches;
  for (std::size_t i = 0; i < results.size(); ++i) {
    matches.push_back(judged(tasks[i], results[i], kind));
    comparisons_.record(tasks[i].query_map_id, tasks[i].reference_map_id,
                        tasks[i].T_reference_query, matches.back().accepted());
  }
  return matches;
}

StopMatch StopMatching::judged(const MatchTask& task, const MatchResult& result,
                               EdgeKind kind) const {
  const double foreseen = expected_overlap(stops_[task.reference_map_id].view->profile,
                                           stops_[task.query_map_id].view->outline,
                                           {task.T_reference_query, task.covariance});
  const Pose2 T_later_earlier =
      result.status == MatchStatus::kSolved
          ? without_prior(result.T_reference_query,
                          kind == EdgeKind::kRevisit ? data_covariance(result) : result.covariance,
                          weak_prior({task.T_reference_query, task.covariance.inverse()}))
          : task.T_reference_query;
  StopMatch match;
  match.edge = {task.query_map_id, task.reference_map_id, kind, geometry::inverse(T_later_earlier),
                geometry::inverse_covariance(T_later_earlier, result.covariance)};
  match.T_later_earlier = {T_later_earlier, result.covariance};
  if (!result.covariance.isZero(0.0)) {
    match.edge.calibrated =
        geometry::inverse_covariance(T_later_earlier, calibration_.of_match(result.covariance));
  }
  match.predicted = inverse({task.T_reference_query, task.covariance});
  match.verdict = result.verdict;
  match.reason = result.reason;
  match.fitness = result.fitness;
  match.doubt = doubt(result);
  match.overlap = result.overlap;
  match.inliers = result.inliers;
  match.violations = result.violations;
  match.rivalry = rivalry(task, result);
  match.weakest_sigma_m = localization::weakest_sigma_m(data_covariance(result));
  match.evidence = step_match(task, result, foreseen, task.query_map_id);
  match.solutions = result.solutions;
  return match;
}

}  // namespace topogeo::localization
