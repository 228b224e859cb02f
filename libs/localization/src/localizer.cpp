#include "topogeo/localization/localizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

constexpr std::uint32_t kLoopsBetweenOptimizations = 10;
constexpr double kOutvoted = 30.0;  // squared Mahalanobis distance of a loop after optimisation

}  // namespace

Localizer::Localizer(LocalizerConfig config, MatchPool& pool) : config_(config), pool_(pool) {}

bool Localizer::add(std::shared_ptr<const LocalMap> map) {
  append(std::move(map));
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  ++version_;
  if (stop == 0) {
    belief_ = {LocalizationState::kTracking, 1.0};
    return false;
  }
  match_recent(stop, graph_.relative_to(stop));
  graph_.place_last_pose();
  const std::vector<UncertainPose> relative = graph_.relative_to(stop);
  stops_[stop].covariance = geometry::inverse_covariance(relative[0].T_a_b, relative[0].covariance);
  if (!match_revisited(stop, relative)) return false;
  optimize();
  return true;
}

void Localizer::append(std::shared_ptr<const LocalMap> map) {
  if (map->id != stops_.size()) {
    throw std::invalid_argument("localizer: local map " + std::to_string(map->id) +
                                " came, expected " + std::to_string(stops_.size()));
  }
  if (!stops_.empty() && map->robot_id != stops_.front().map->robot_id) {
    throw std::invalid_argument("localizer: local map " + std::to_string(map->id) +
                                " is of robot '" + map->robot_id + "', expected '" +
                                stops_.front().map->robot_id + "'");
  }
  pool_.add_map(map);
  Stop stop;
  stop.hash = topomap::content_hash(*map);
  MatchFeatures features = extract_scan_features(map->points, map->T_robot_laser);
  stop.profile = std::move(features.profile);
  const std::size_t stride = std::max<std::size_t>(1, features.coarse_m.size() / 40);
  for (std::size_t i = 0; i < features.coarse_m.size(); i += stride) {
    stop.outline_m.push_back(features.coarse_m[i]);
  }
  if (stops_.empty()) {
    graph_.add_pose(Pose2{});
  } else {
    const Stop& previous = stops_.back();
    const UncertainPose odometry =
        odometry_between_stops(previous.map->T_odom_robot, *map, config_.odometry);
    const auto id = static_cast<std::uint32_t>(stops_.size());
    stop.way_m = previous.way_m + std::sqrt(odometry.T_a_b.position_m().squaredNorm());
    graph_.add_pose(graph_.poses().back() * odometry.T_a_b);
    // A standing robot has no odometry error, but an edge needs a covariance that can be inverted.
    Eigen::Matrix3d covariance = odometry.covariance;
    covariance(0, 0) += 1e-4;
    covariance(1, 1) += 1e-4;
    covariance(2, 2) += 1e-5;
    graph_.add_edge({id - 1, id, EdgeKind::kOdometry, odometry.T_a_b, covariance});
  }
  stop.map = std::move(map);
  stops_.push_back(std::move(stop));
}

void Localizer::match_recent(std::uint32_t stop, const std::vector<UncertainPose>& relative) {
  std::vector<MatchTask> tasks;
  const Pose2 T_previous_robot = stops_[stop].map->T_previous_robot;
  for (const Candidate& candidate : candidates(stop, relative, true, config_.recent_matches)) {
    MatchTask task = make_task(stop, candidate.id, relative[candidate.id]);
    const Pose2 T_candidate_previous =
        geometry::between(graph_.poses()[candidate.id], graph_.poses()[stop - 1]);
    task.initial_individuals.push_back(geometry::inverse(T_candidate_previous * T_previous_robot));
    for (const MatchSolution& solution : last_solutions_[candidate.id]) {
      task.initial_individuals.push_back(geometry::inverse(T_previous_robot) *
                                         solution.T_reference_query);
    }
    tasks.push_back(std::move(task));
  }
  last_solutions_.clear();
  const std::vector<Answer> answers = run(tasks, EdgeKind::kSequential);
  // Odometry alone can be tens of degrees off in one step. Where no match is beyond doubt,
  // uncertain ones, with their wide covariance, still say more than it does.
  const bool any =
      std::any_of(answers.begin(), answers.end(), [](const Answer& a) { return a.accepted; });
  if (!any) ++counts_.steps_in_doubt;
  for (const Answer& answer : answers) {
    if (answer.accepted || !any) graph_.add_edge(answer.edge);
  }
}

bool Localizer::match_revisited(std::uint32_t stop, const std::vector<UncertainPose>& relative) {
  std::vector<MatchTask> tasks;
  for (const Candidate& candidate : candidates(stop, relative, false, config_.revisit_matches)) {
    tasks.push_back(make_task(stop, candidate.id, relative[candidate.id]));
  }
  bool moved = false;
  for (const Answer& answer : run(tasks, EdgeKind::kRevisit)) {
    if (answer.accepted) moved |= add_loop(answer.edge);
  }
  return moved;
}

// Takes a loop into the graph, or keeps it until another one agrees. True when it is time to
// optimise.
bool Localizer::add_loop(const PoseGraphEdge& edge) {
  const Pose2 T_map_now = graph_.poses()[edge.to];
  const Pose2 T_map_corrected = graph_.poses()[edge.from] * edge.T_from_to;
  const auto apart = [this](const Pose2& a, const Pose2& b) {
    return (a.position_m() - b.position_m()).squaredNorm() >
               config_.unaided_correction_m * config_.unaided_correction_m ||
           std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) >
               config_.unaided_correction_rad;
  };
  ++loops_since_optimization_;
  if (!apart(T_map_now, T_map_corrected)) {
    graph_.add_edge(edge);
    const double moved_m2 = (T_map_now.position_m() - T_map_corrected.position_m()).squaredNorm();
    return moved_m2 > 0.01 || loops_since_optimization_ >= kLoopsBetweenOptimizations;
  }
  const Pose2 correction = T_map_corrected * geometry::inverse(T_map_now);
  constexpr std::uint32_t kLongestWait = 12;  // stops
  std::erase_if(pending_,
                [&](const PendingLoop& loop) { return loop.edge.to + kLongestWait < edge.to; });
  const auto agrees = [&](const PendingLoop& loop) {
    return loop.edge.to != edge.to && !apart(loop.correction * T_map_now, T_map_corrected);
  };
  bool confirmed = false;
  for (const PendingLoop& loop : pending_) {
    if (!agrees(loop)) continue;
    graph_.add_edge(loop.edge);
    confirmed = true;
  }
  std::erase_if(pending_, agrees);
  if (confirmed) {
    graph_.add_edge(edge);
    return true;
  }
  pending_.push_back({edge, correction});
  compared_.erase({edge.from, edge.to});  // it is not in the graph, so it may be compared again
  ++counts_.unconfirmed_loops;
  return false;
}

void Localizer::finish() {
  if (stops_.size() < 2) return;
  optimize();
  for (std::uint32_t pass = 0; pass < config_.final_passes; ++pass) {
    if (match_all_revisits() == 0) break;
    optimize();
  }
}

std::size_t Localizer::match_all_revisits() {
  std::vector<MatchTask> tasks;
  for (std::uint32_t stop = 1; stop < stops_.size(); ++stop) {
    const std::vector<UncertainPose> relative = graph_.relative_to(stop);
    for (const Candidate& candidate : candidates(stop, relative, false, config_.revisit_matches)) {
      tasks.push_back(make_task(stop, candidate.id, relative[candidate.id]));
    }
  }
  const std::size_t before = graph_.edges().size();
  pending_.clear();
  for (const Answer& answer : run(tasks, EdgeKind::kRevisit)) {
    if (answer.accepted) add_loop(answer.edge);
  }
  return graph_.edges().size() - before;
}

void Localizer::optimize() {
  ++counts_.optimizations;
  loops_since_optimization_ = 0;
  if (!graph_.optimize().usable) {
    ++counts_.failed_optimizations;
    return;
  }
  const std::size_t removed = graph_.remove_edges(EdgeKind::kRevisit, kOutvoted);
  if (removed > 0) {
    counts_.removed_loops += removed;
    graph_.optimize();
  }
  const std::vector<UncertainPose> relative = graph_.relative_to(0);
  for (std::size_t i = 1; i < stops_.size(); ++i) stops_[i].covariance = relative[i].covariance;
  ++version_;
}

topomap::Trajectory Localizer::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = version_;
  trajectory.stops.reserve(stops_.size());
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    trajectory.stops.push_back(
        {stops_[i].map->id, stops_[i].map->stamp_ns, graph_.poses()[i], stops_[i].covariance});
  }
  return trajectory;
}

std::vector<topomap::LoopClosure> Localizer::loop_closures() const {
  std::vector<topomap::LoopClosure> closures;
  for (const PoseGraphEdge& edge : graph_.edges()) {
    if (edge.kind == EdgeKind::kRevisit) closures.push_back({edge.from, edge.to, edge.T_from_to});
  }
  return closures;
}

}  // namespace topogeo::localization
