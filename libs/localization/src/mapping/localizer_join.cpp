// The part of Localizer that goes on with a stored map and takes drives into it.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "topogeo/localization/mapping/localizer.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

// Of the matches that a stored map does not say more of: a usual one is about that good.
constexpr double kMatchSigma_m = 0.02;
constexpr double kMatchSigma_rad = 0.008;

Eigen::Matrix3d usual_covariance() {
  return Eigen::Vector3d(kMatchSigma_m * kMatchSigma_m, kMatchSigma_m * kMatchSigma_m,
                         kMatchSigma_rad * kMatchSigma_rad)
      .asDiagonal();
}

}  // namespace

std::vector<PoseGraphEdge> edges_of(const StoredMap& map) {
  std::vector<PoseGraphEdge> edges;
  const std::vector<topomap::StopPose>& stops = map.trajectory.stops;
  for (std::uint32_t i = 1; i < stops.size(); ++i) {
    // Drives hang together by their loops.
    const double weaker = map.maps[i].starts_drive ? 100.0 : 1.0;
    edges.push_back({i - 1, i, EdgeKind::kSequential,
                     geometry::between(stops[i - 1].T_map_robot, stops[i].T_map_robot),
                     weaker * usual_covariance()});
  }
  for (const topomap::LoopClosure& loop : map.loop_closures) {
    edges.push_back({loop.earlier_id, loop.later_id, EdgeKind::kRevisit, loop.T_earlier_later,
                     usual_covariance()});
  }
  return edges;
}

Localizer::Localizer(LocalizerConfig config, MatchPool& pool, GraphOptimizer* optimizer,
                     const std::shared_ptr<const StoredMap>& stored)
    : Localizer(config, pool, optimizer) {
  if (stored->maps.empty() || stored->maps.size() != stored->trajectory.stops.size()) {
    throw std::invalid_argument(
        "localizer: a stored map of " + std::to_string(stored->maps.size()) + " local maps and " +
        std::to_string(stored->trajectory.stops.size()) + " stops, expected as many, at least one");
  }
  for (const LocalMap& map : stored->maps) {
    restore(*stored, std::shared_ptr<const LocalMap>(stored, &map));
  }
  for (const PoseGraphEdge& edge : edges_of(*stored)) {
    graph_.add_edge(edge);
    stops_[edge.to].compared[edge.from] = {geometry::inverse(edge.T_from_to), true};
  }
  version_ = stored->trajectory.version;
  stored_stops_ = stops_.size();
}

void Localizer::restore(const StoredMap& stored, const std::shared_ptr<const LocalMap>& map) {
  check_next(*map, stops_.size(), stops_.empty() ? nullptr : stops_.front().map.get());
  pool_.add_map(map);
  Stop stop = described(map);
  const topomap::StopPose& pose = stored.trajectory.stops[stops_.size()];
  stop.covariance = pose.covariance;
  if (!stops_.empty()) {
    const Pose2 step = geometry::between(graph_.poses().back(), pose.T_map_robot);
    stop.way_m = stops_.back().way_m + std::sqrt(step.position_m().squaredNorm());
  }
  graph_.add_pose(pose.T_map_robot);
  stops_.push_back(std::move(stop));
  StepEvidence known;  // what is in the map is right by definition
  known.points = map->points.size();
  monitor_.restart(1.0);
  monitor_.add(known);
}

void Localizer::join(std::span<const std::shared_ptr<const LocalMap>> drive,
                     std::span<const StoredMatch> matches_of_last, double confidence) {
  if (drive.empty() || matches_of_last.empty() || stops_.empty()) {
    throw std::invalid_argument("localizer: a drive joins a map by its stops and their matches");
  }
  settle();
  gap_ = way_to(drive, matches_of_last);
  last_solutions_.clear();
  monitor_.restart(confidence);
  const auto first = static_cast<std::uint32_t>(stops_.size());
  for (const std::shared_ptr<const LocalMap>& map : drive) add(map);
  add_missing(matches_of_last);
  optimize_now();
  // Now that the drive has its place: what else of the map did it see?
  std::vector<std::uint32_t> joined;
  for (std::uint32_t stop = first; stop < stops_.size(); ++stop) joined.push_back(stop);
  if (match_revisits_of(joined) > 0) optimize_now();
}

// From the last stop of the map to the first one of the drive, backwards by the drive's odometry.
UncertainPose Localizer::way_to(std::span<const std::shared_ptr<const LocalMap>> drive,
                                std::span<const StoredMatch> matches_of_last) const {
  UncertainPose T_first_last;
  for (std::size_t i = 1; i < drive.size(); ++i) {
    T_first_last = compose(T_first_last, odometry_between_stops(drive[i - 1]->T_odom_robot,
                                                                *drive[i], config_.odometry));
  }
  const StoredMatch& best = *std::min_element(
      matches_of_last.begin(), matches_of_last.end(), [](const auto& a, const auto& b) {
        return PoseGraph::path_cost(a.T_stop_robot.covariance) <
               PoseGraph::path_cost(b.T_stop_robot.covariance);
      });
  const auto end = static_cast<std::uint32_t>(stops_.size() - 1);
  const UncertainPose T_end_stop = graph_.relative_to(end).at(best.stop);
  return compose(T_end_stop, compose(best.T_stop_robot, inverse(T_first_last)));
}

// The matches by which the drive was found, as far as it was not matched there again.
void Localizer::add_missing(std::span<const StoredMatch> matches_of_last) {
  const auto last = static_cast<std::uint32_t>(stops_.size() - 1);
  for (const StoredMatch& match : matches_of_last) {
    const PoseGraphEdge edge{match.stop, last, EdgeKind::kRevisit, match.T_stop_robot.T_a_b,
                             match.T_stop_robot.covariance};
    const auto same = [&](const PoseGraphEdge& other) {
      return other.kind == edge.kind && other.from == edge.from && other.to == edge.to;
    };
    if (std::any_of(graph_.edges().begin(), graph_.edges().end(), same) ||
        std::any_of(new_loops_.begin(), new_loops_.end(), same)) {
      continue;
    }
    decide(edge, LoopOutcome::kAccepted, Reason::kNone, match.fitness);
    stops_[last].compared[edge.from] = {geometry::inverse(edge.T_from_to), true};
    new_loops_.push_back(edge);
  }
}

}  // namespace topogeo::localization
