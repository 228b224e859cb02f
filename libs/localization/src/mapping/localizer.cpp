#include "topogeo/localization/mapping/localizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/localization/matching/expected_overlap.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

constexpr double kWidening = 3.0;  // of the deviations, when nothing was found where odometry says

}  // namespace

Localizer::Localizer(LocalizerConfig config, MatchPool& pool, GraphOptimizer* optimizer)
    : config_(config), pool_(pool), optimizer_(optimizer) {}

bool Localizer::add(std::shared_ptr<const LocalMap> map) {
  append(std::move(map));
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  ++version_;
  if (stop == 0) {
    believe(stop, {});
    return false;
  }
  const bool moved = finish_optimization(stop);
  std::vector<StepMatch> evidence;
  match_recent(stop, evidence);
  graph_.place_last_pose();
  stops_[stop].covariance = covariance_in_map(stop);
  match_revisited(stop, evidence);
  believe(stop, std::move(evidence));
  start_optimization(stop);
  return finish_optimization(stop) || moved;
}

Localizer::Stop Localizer::described(std::shared_ptr<const LocalMap> map) {
  Stop stop;
  stop.hash = topomap::content_hash(*map);
  MatchFeatures features = extract_scan_features(map->points, map->T_robot_laser);
  stop.profile = std::move(features.profile);
  stop.outline = outline_of(features.coarse);
  stop.map = std::move(map);
  return stop;
}

void Localizer::append(std::shared_ptr<const LocalMap> map) {
  check_next(*map, stops_.size(), stops_.empty() ? nullptr : stops_.front().map.get());
  pool_.add_map(map);
  Stop stop = described(std::move(map));
  if (stops_.empty()) {
    graph_.add_pose(Pose2{});
  } else {
    const Stop& previous = stops_.back();
    const bool gap = gap_.has_value();
    const UncertainPose step =
        gap ? *std::exchange(gap_, std::nullopt)
            : odometry_between_stops(previous.map->T_odom_robot, *stop.map, config_.odometry);
    const auto id = static_cast<std::uint32_t>(stops_.size());
    // No stop from before a gap is a recent one.
    stop.way_m = previous.way_m + (gap ? 2.0 * config_.recent_way_m
                                       : std::sqrt(step.T_a_b.position_m().squaredNorm()));
    graph_.add_pose(graph_.poses().back() * step.T_a_b);
    // A standing robot has no odometry error, but an edge needs a covariance that can be inverted.
    graph_.add_edge({id - 1, id, EdgeKind::kOdometry, step.T_a_b,
                     invertible(gap ? step.covariance : odometry_.widened(step.covariance))});
  }
  stops_.push_back(std::move(stop));
}

void Localizer::match_recent(std::uint32_t stop, std::vector<StepMatch>& evidence) {
  const std::uint32_t first = first_recent(stop);
  const std::vector<UncertainPose> relative =
      graph_.relative_to(stop, {first, PoseGraph::kUnlimited});
  std::vector<Answer> answers =
      run(recent_tasks(stop, relative, 1.0), EdgeKind::kSequential, &evidence);
  const auto any_accepted = [](const std::vector<Answer>& given) {
    return std::any_of(given.begin(), given.end(), [](const Answer& a) { return a.accepted; });
  };
  if (!any_accepted(answers)) {
    // Odometry may be worse than it ever was: once more, in a wider space.
    std::vector<StepMatch> wider_evidence;
    std::vector<Answer> wider =
        run(recent_tasks(stop, relative, kWidening), EdgeKind::kSequential, &wider_evidence);
    if (any_accepted(wider)) {
      answers = std::move(wider);
      evidence = std::move(wider_evidence);
    }
  }
  last_solutions_ = std::exchange(new_solutions_, {});
  // Odometry alone can be tens of degrees off in one step. Where no match is beyond doubt,
  // uncertain ones, with their wide covariance, still say more than it does.
  const bool any = any_accepted(answers);
  if (!any) ++counts_.steps_in_doubt;
  for (const Answer& answer : answers) {
    if (answer.accepted || !any) graph_.add_edge(answer.edge);
    if (answer.accepted && answer.edge.from + 1 == stop) watch_odometry(answer.edge);
  }
}

std::vector<MatchTask> Localizer::recent_tasks(std::uint32_t stop,
                                               const std::vector<UncertainPose>& relative,
                                               double widening) {
  std::vector<MatchTask> tasks;
  const Pose2 T_previous_robot = stops_[stop].map->T_previous_robot;
  for (const Candidate& candidate : candidates(stop, relative, true, config_.recent_matches)) {
    UncertainPose prior = relative[candidate.id];
    prior.covariance *= widening * widening;
    MatchTask task = make_task(stop, candidate.id, prior);
    const Pose2 T_candidate_previous =
        geometry::between(graph_.poses()[candidate.id], graph_.poses()[stop - 1]);
    task.initial_individuals.push_back(geometry::inverse(T_candidate_previous * T_previous_robot));
    for (const MatchSolution& solution : last_solutions_[candidate.id]) {
      task.initial_individuals.push_back(geometry::inverse(T_previous_robot) *
                                         solution.T_reference_query);
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

void Localizer::watch_odometry(const PoseGraphEdge& match) {
  const LocalMap& map = *stops_[match.to].map;
  const UncertainPose odometry =
      odometry_between_stops(stops_[match.from].map->T_odom_robot, map, config_.odometry);
  odometry_.add(odometry, {match.T_from_to, match.covariance});
}

void Localizer::match_revisited(std::uint32_t stop, std::vector<StepMatch>& evidence) {
  const std::vector<UncertainPose> relative = graph_.relative_to(stop, searchable_reach());
  std::vector<MatchTask> tasks;
  for (const Candidate& candidate : candidates(stop, relative, false, config_.revisit_matches)) {
    tasks.push_back(make_task(stop, candidate.id, relative[candidate.id]));
  }
  for (const Answer& answer : run(tasks, EdgeKind::kRevisit, &evidence)) {
    if (answer.accepted) add_loop(answer);
  }
}

void Localizer::believe(std::uint32_t stop, std::vector<StepMatch> matches) {
  StepEvidence evidence;
  evidence.matches = std::move(matches);
  evidence.points = stops_[stop].map->points.size();
  if (stop > 0) {
    evidence.way_m = stops_[stop].way_m - stops_[stop - 1].way_m;
    // By the stop that this one is known best from.
    std::optional<Eigen::Matrix3d> best;
    for (const auto& [from, covariance] : graph_.links_to(stop)) {
      if (!best || PoseGraph::path_cost(covariance) < PoseGraph::path_cost(*best)) {
        best = covariance;
      }
    }
    evidence.covariance = best.value();  // odometry always leads here
  }
  monitor_.add(evidence);
}

// Along the best of the ways by which the matches and odometry of this step lead here.
Eigen::Matrix3d Localizer::covariance_in_map(std::uint32_t stop) const {
  std::optional<Eigen::Matrix3d> best;
  for (const auto& [from, link] : graph_.links_to(stop)) {
    const Eigen::Matrix3d covariance = geometry::compose_covariance(
        graph_.poses()[from], stops_[from].covariance,
        geometry::between(graph_.poses()[from], graph_.poses()[stop]), link);
    if (!best || PoseGraph::path_cost(covariance) < PoseGraph::path_cost(*best)) best = covariance;
  }
  return best.value();  // odometry always leads here
}

topomap::Trajectory Localizer::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = version_;
  trajectory.stops.reserve(stops_.size());
  for (std::size_t i = 0; i < stops_.size(); ++i) trajectory.stops.push_back(pose_of(i));
  return trajectory;
}

std::optional<topomap::StopPose> Localizer::last_stop() const {
  if (stops_.empty()) return std::nullopt;
  return pose_of(stops_.size() - 1);
}

topomap::StopPose Localizer::pose_of(std::size_t stop) const {
  const LocalMap& map = *stops_[stop].map;
  return {map.id, map.stamp_ns, graph_.poses()[stop], stops_[stop].covariance, map.id};
}

std::vector<topomap::LoopClosure> Localizer::loop_closures() const {
  std::vector<topomap::LoopClosure> closures;
  for (const PoseGraphEdge& edge : graph_.edges()) {
    if (edge.kind == EdgeKind::kRevisit) closures.push_back({edge.from, edge.to, edge.T_from_to});
  }
  return closures;
}

}  // namespace topogeo::localization
