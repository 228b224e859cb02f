#include "topogeo/slam/pose_graph_slam.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "topogeo/slam/graph_optimization.hpp"
#include "topogeo/slam/stored_map.hpp"

#include "link_covariances.hpp"
#include "loop/look_alikes.hpp"
#include "loop/loop_closing.hpp"
#include "odometry_steps.hpp"
#include "optimization_schedule.hpp"
#include "stop_matching.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

// A stop that an optimisation after the end of a log moved less than this sees the same places.
constexpr double kMovedAtEnd_m = 0.1;
constexpr double kMovedAtEnd_rad = 0.02;

// A match that half of the visible points contradict carries no information.
constexpr double kLeastContradicted = 0.5;

// Only these can have come near other stops.
std::vector<std::uint32_t> moved_stops(std::span<const Pose2> before,
                                       std::span<const Pose2> after) {
  std::vector<std::uint32_t> moved;
  for (std::uint32_t stop = 1; stop < before.size(); ++stop) {
    const Pose2& a = before[stop];
    const Pose2& b = after[stop];
    const double distance_m = std::sqrt((a.position_m() - b.position_m()).squaredNorm());
    const double turn_rad = std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad));
    if (distance_m > kMovedAtEnd_m || turn_rad > kMovedAtEnd_rad) moved.push_back(stop);
  }
  return moved;
}

}  // namespace

struct PoseGraphSlam::Parts {
  StopMatching matching;
  LoopClosing loops;
  OptimizationSchedule schedule;
  OdometrySteps steps{};
};

PoseGraphSlam::PoseGraphSlam(const LocalizerConfig& config, MatchPool& pool,
                             GraphOptimizer* optimizer)
    : config_(config),
      parts_(std::in_place, StopMatching(config, pool), LoopClosing(config),
             OptimizationSchedule(optimizer, config.optimization_delay)) {}

PoseGraphSlam::PoseGraphSlam(const PoseGraphSlam&) = default;
PoseGraphSlam::~PoseGraphSlam() = default;

bool PoseGraphSlam::add(MapPointer map) {
  append(std::move(map));
  ++version_;
  const std::uint32_t stop = last();
  if (stop == 0) {
    judge_state({});
    return false;
  }
  const bool moved = apply(parts_->schedule.fetch(stop));
  std::vector<StepMatch> evidence = place_last();
  const std::vector<StepMatch> of_loops = match_revisited({&stop, 1});
  evidence.insert(evidence.end(), of_loops.begin(), of_loops.end());
  judge_state(std::move(evidence));
  parts_->schedule.start(stop, graph_, parts_->loops.waiting());
  return apply(parts_->schedule.fetch(stop)) || moved;
}

// --- stops

std::uint32_t PoseGraphSlam::last() const {
  return static_cast<std::uint32_t>(parts_->matching.size() - 1);
}

// Null if the first stop belongs to another session, which may be of another robot.
const LocalMap* PoseGraphSlam::first_of_session(const LocalMap& map) const {
  const LocalMap& first = parts_->matching.map(0);
  return first.stop.session == map.stop.session ? &first : nullptr;
}

void PoseGraphSlam::append(MapPointer map) {
  const bool first = parts_->matching.size() == 0;
  check_next(*map, parts_->matching.size(), first ? nullptr : first_of_session(*map));
  if (first) {
    graph_.add_pose(Pose2{});
    parts_->steps.add_none();
    parts_->matching.add(std::move(map), 0.0);
  } else {
    const std::optional<UncertainPose> gap = std::exchange(gap_, std::nullopt);
    if (gap) {
      parts_->steps.add_gap(*gap);
    } else {
      parts_->steps.add(odometry_between_stops(parts_->matching.map(last()).T_odom_robot, *map,
                                               config_.odometry));
    }
    const Pose2& T_before_stop = parts_->steps.last().T_a_b;
    graph_.add_pose(graph_.poses().back() * T_before_stop);
    graph_.add_edge(parts_->steps.edge());
    // No stop from before a gap is a recent one.
    parts_->matching.add(std::move(map), gap ? 2.0 * config_.recent_way_m
                                             : std::sqrt(T_before_stop.position_m().squaredNorm()));
  }
  covariances_.emplace_back(Eigen::Matrix3d::Zero());
}

// Places the last stop relative to recent ones.
std::vector<StepMatch> PoseGraphSlam::place_last() {
  std::vector<StepMatch> evidence = match_recent();
  graph_.place_last_pose();
  covariances_[last()] = covariance_in_map(graph_, covariances_, last());
  return evidence;
}

std::vector<StepMatch> PoseGraphSlam::match_recent() {
  std::vector<StopMatch> matches = parts_->matching.match_recent(graph_);
  refuse_look_alikes(matches, parts_->steps);
  const std::vector<StopMatch> further = match_further(matches);
  // Odometry alone can be tens of degrees off in one step. If no match is accepted, uncertain ones,
  // with their wide covariance, are still better.
  const bool any = any_accepted(matches);
  if (!any) {
    ++steps_in_doubt_;
    graph_.add_edge(parts_->steps.edge_without_match());
  }
  std::vector<StepMatch> evidence;
  for (const StopMatch& match : matches) {
    evidence.push_back(match.evidence);
    if (match.accepted() || (!any && match.uncertain() && match.violations < kLeastContradicted &&
                             parts_->steps.allow(match.edge, OdometryMonitor::kNear2))) {
      graph_.add_edge(match.edge);
    }
    if (match.accepted() && match.edge.from + 1 == last()) {
      parts_->steps.learn({match.edge.T_from_to, match.edge.covariance});
    }
  }
  for (const StopMatch& match : further) {
    evidence.push_back(match.evidence);
    graph_.add_edge(match.edge);
  }
  return evidence;
}

// If no regular search succeeded, compares with stops that odometry is too uncertain to search. A
// match found there replaces those of the widened search.
std::vector<StopMatch> PoseGraphSlam::match_further(std::vector<StopMatch>& matches) {
  if (std::any_of(matches.begin(), matches.end(),
                  [](const StopMatch& match) { return match.accepted() && !match.widened; })) {
    return {};
  }
  std::vector<StopMatch> further = parts_->matching.match_unsearchable(graph_);
  refuse_look_alikes(further, parts_->steps);
  std::erase_if(further, [](const StopMatch& match) { return !match.accepted(); });
  if (!further.empty()) {
    std::erase_if(matches, [](const StopMatch& match) { return match.widened; });
  }
  return further;
}

// Closes loops between these stops and earlier places.
std::vector<StepMatch> PoseGraphSlam::match_revisited(std::span<const std::uint32_t> stops) {
  const std::vector<StopMatch> matches = parts_->matching.match_revisited(graph_, stops);
  const LoopClosing::Round round = parts_->loops.judge(graph_, matches, parts_->matching.path_m());
  for (const PoseGraphEdge& pending : round.pending) parts_->matching.reopen(pending);
  for (const PoseGraphEdge& loop : round.added) parts_->schedule.count_loop(loop);
  if (round.moves) parts_->schedule.want();
  std::vector<StepMatch> evidence;
  evidence.reserve(matches.size());
  for (const StopMatch& match : matches) evidence.push_back(match.evidence);
  return evidence;
}

void PoseGraphSlam::judge_state(std::vector<StepMatch> matches) {
  const std::uint32_t stop = last();
  StepEvidence evidence;
  evidence.matches = std::move(matches);
  evidence.points = parts_->matching.map(stop).points.size();
  if (stop > 0) {
    evidence.distance_m = parts_->matching.path_m(stop) - parts_->matching.path_m(stop - 1);
    evidence.covariance = best_link_to(graph_, stop);
  }
  monitor_.add(evidence);
}

// --- optimisation

// True if there is a result, which may have moved earlier poses.
bool PoseGraphSlam::apply(const std::optional<FinishedOptimization>& finished) {
  if (!finished) return false;
  for (const PoseGraphEdge& loop : parts_->loops.release(finished->loops)) graph_.add_edge(loop);
  const GraphSolution& solution = finished->solution;
  if (!solution.summary.usable) return true;
  graph_.move(solution.stops, solution.T_map_robot);
  graph_.remove_edges(solution.outvoted);
  parts_->loops.outvote(graph_, solution.outvoted);
  update_covariances(solution);
  ++version_;
  return true;
}

// An optimisation of all stops updates all covariances. Otherwise only its stops and all later ones
// are updated, from the earlier stops that they were matched with.
void PoseGraphSlam::update_covariances(const GraphSolution& solution) {
  if (solution.whole) {
    const std::vector<UncertainPose> T_map_stop = graph_.relative_to(0);
    for (std::size_t i = 0; i < T_map_stop.size(); ++i) covariances_[i] = T_map_stop[i].covariance;
    return;
  }
  for (const std::uint32_t stop : solution.stops) {
    if (stop > 0) covariances_[stop] = covariance_in_map(graph_, covariances_, stop);
  }
  for (std::uint32_t stop = solution.stops.back() + 1; stop < covariances_.size(); ++stop) {
    covariances_[stop] = covariance_in_map(graph_, covariances_, stop);
  }
}

void PoseGraphSlam::rescale_steps() {
  for (std::uint32_t stop = 1; stop <= last(); ++stop) {
    if (const std::optional<Pose2> step = parts_->steps.rescaled(stop))
      graph_.correct_step(stop, *step);
  }
}

void PoseGraphSlam::optimize_now() {
  apply(parts_->schedule.fetch_now());
  rescale_steps();
  parts_->schedule.want_whole();
  parts_->schedule.start(last(), graph_, parts_->loops.waiting());
  apply(parts_->schedule.fetch_now());
}

void PoseGraphSlam::compare_stored(std::uint32_t first) {
  close_all_loops(std::max(1U, first));
}

void PoseGraphSlam::finish() {
  if (parts_->matching.size() < 2) return;
  optimize_now();
  // The stops of a stored map were compared with each other when it was made.
  const std::size_t first = std::max<std::size_t>(1, stored_stops_);
  if (first >= parts_->matching.size()) return;
  close_all_loops(static_cast<std::uint32_t>(first));
}

// Compares the stops from `first` on, and again all stops that this moves.
void PoseGraphSlam::close_all_loops(std::uint32_t first) {
  std::vector<std::uint32_t> again(parts_->matching.size() - first);
  std::iota(again.begin(), again.end(), first);
  for (std::uint32_t pass = 0; pass < config_.final_passes; ++pass) {
    if (close_more_loops(again) == 0) break;
    const std::vector<Pose2> before = graph_.poses();
    optimize_now();
    again = moved_stops(before, graph_.poses());
  }
}

// Returns how many loops were closed.
std::size_t PoseGraphSlam::close_more_loops(std::span<const std::uint32_t> stops) {
  const std::size_t before = graph_.edges().size() + parts_->loops.waiting().size();
  parts_->loops.drop_pending();
  match_revisited(stops);
  return graph_.edges().size() + parts_->loops.waiting().size() - before;
}

// --- stored maps and the drives that join them

PoseGraphSlam::PoseGraphSlam(const LocalizerConfig& config, MatchPool& pool,
                             GraphOptimizer* optimizer,
                             const std::shared_ptr<const StoredMap>& stored)
    : PoseGraphSlam(config, pool, optimizer) {
  check(*stored);
  for (std::size_t i = 0; i < stored->maps.size(); ++i) {
    restore(MapPointer(stored, &stored->maps[i]), stored->trajectory.stops[i]);
  }
  for (const PoseGraphEdge& edge : edges_of(*stored)) {
    graph_.add_edge(edge);
    parts_->matching.skip(edge);
  }
  edges_known_ = !stored->edges.empty() || stored->maps.size() == 1;
  version_ = stored->trajectory.version;
  stored_stops_ = parts_->matching.size();
}

void PoseGraphSlam::restore(MapPointer map, const topomap::StopPose& pose) {
  const bool first = parts_->matching.size() == 0;
  check_next(*map, parts_->matching.size(), first ? nullptr : first_of_session(*map));
  StepEvidence known;  // the map is right by definition
  known.points = map->points.size();
  double distance_m = 0.0;
  if (!first) {
    const Pose2 step = geometry::between(graph_.poses().back(), pose.T_map_robot);
    distance_m = std::sqrt(step.position_m().squaredNorm());
    if (map->starts_drive) distance_m += 2.0 * config_.recent_way_m;  // as in append()
  }
  parts_->matching.add(std::move(map), distance_m);
  parts_->steps.add_none();
  graph_.add_pose(pose.T_map_robot);
  covariances_.push_back(pose.covariance);
  monitor_.restart(1.0);
  monitor_.add(known);
}

void PoseGraphSlam::join(std::span<const MapPointer> drive,
                         std::span<const StoredMatch> matches_of_last, double confidence) {
  apply(parts_->schedule.fetch_now());
  gap_ = first_stop_of_drive(graph_, drive, matches_of_last, config_.odometry);
  parts_->matching.forget_solutions();
  monitor_.restart(confidence);
  const auto first = static_cast<std::uint32_t>(parts_->matching.size());
  // The drive is first placed alone: its odometry may put its first stops, far from the last one,
  // on top of other stops.
  for (const MapPointer& map : drive) {
    append(map);
    ++version_;
    judge_state(place_last());
  }
  // The matches that located the drive, unless it was matched there again.
  for (const StoredMatch& match : matches_of_last) {
    const PoseGraphEdge loop = loop_of(match, last());
    if (contains_like(graph_.edges(), loop) || contains_like(parts_->loops.waiting(), loop))
      continue;
    parts_->loops.accept_tracked(graph_, loop, match.fitness);
    parts_->matching.skip(loop);
  }
  optimize_now();
  close_all_loops(first);  // now that the drive has its place
}

// --- state

void PoseGraphSlam::settle() {
  apply(parts_->schedule.fetch_now());
}

void PoseGraphSlam::number_tasks_from(std::uint64_t next_task) {
  parts_->matching.requests().number_from(next_task);
}

std::uint64_t PoseGraphSlam::next_task() const {
  return parts_->matching.requests().next_task();
}

const std::vector<LoopDecision>& PoseGraphSlam::loop_decisions() const {
  return parts_->loops.decisions();
}

topomap::Trajectory PoseGraphSlam::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = version_;
  trajectory.stops.reserve(parts_->matching.size());
  for (std::size_t i = 0; i < parts_->matching.size(); ++i) trajectory.stops.push_back(pose_of(i));
  return trajectory;
}

std::optional<topomap::StopPose> PoseGraphSlam::last_stop() const {
  if (parts_->matching.size() == 0) return std::nullopt;
  return pose_of(last());
}

topomap::StopPose PoseGraphSlam::pose_of(std::size_t stop) const {
  const LocalMap& map = parts_->matching.map(stop);
  return {map.id, map.stamp_ns, graph_.poses()[stop], covariances_[stop], map.id};
}

std::vector<topomap::LoopClosure> PoseGraphSlam::loop_closures() const {
  std::vector<topomap::LoopClosure> closures;
  for (const PoseGraphEdge& edge : graph_.edges()) {
    if (edge.kind == EdgeKind::kRevisit) closures.push_back({edge.from, edge.to, edge.T_from_to});
  }
  return closures;
}

SlamCounts PoseGraphSlam::counts() const {
  SlamCounts counts{parts_->matching.requests().counts()};
  counts.steps_in_doubt = steps_in_doubt_;
  counts.unconfirmed_loops = parts_->loops.unconfirmed();
  counts.optimizations = parts_->schedule.optimizations();
  counts.failed_optimizations = parts_->schedule.failed();
  counts.removed_loops = parts_->loops.outvoted();
  return counts;
}

}  // namespace topogeo::localization
