#include "topogeo/thesis/thesis_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/matching/expected_overlap.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/slam/slam.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

ThesisMap::ThesisMap(const LocalizerConfig& config, std::uint32_t solutions_per_pair)
    : config_(config), solutions_(solutions_per_pair) {}

void ThesisMap::append(std::shared_ptr<const LocalMap> map) {
  check_next(*map, stops_.size(), stops_.empty() ? nullptr : stops_.front().map.get());
  ThesisStop stop;
  const bool by_walls = config_.evidence != MatchEvidence::kFitness;
  LocalMap seen = *map;
  seen.points = points_for(*map, config_.evidence);
  stop.view = visible_rectangle(seen, by_walls);
  MatchFeatures features = extract_features(seen);
  if (by_walls) {
    stop.profile = std::move(features.profile);
    stop.outline = outline_of(features.coarse);
  }
  for (const topomap::LocalNode& node : features.nodes) stop.landmarks_m.push_back(node.position_m);
  for (const BranchSample& sample : features.branches) {
    stop.landmarks_m.push_back(sample.position_m);
  }
  if (!stops_.empty()) {
    const ThesisStop& previous = stops_.back();
    stop.T_previous_this =
        odometry_between_stops(previous.map->T_odom_robot, *map, config_.odometry);
    stop.T_previous_this.covariance = invertible(stop.T_previous_this.covariance);
    stop.path_m =
        previous.path_m + std::sqrt(stop.T_previous_this.T_a_b.position_m().squaredNorm());
  }
  stop.map = std::move(map);
  stops_.push_back(std::move(stop));
  ++version_;
}

void ThesisMap::place_first() {
  graph_.add_pose(Pose2{});
}

void ThesisMap::place(std::uint32_t from, const UncertainPose& T_from_stop, bool match) {
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  const UncertainPose& odometry = stops_[stop].T_previous_this;
  const Pose2 T_map_from = graph_.poses()[from];
  graph_.add_pose(T_map_from * T_from_stop.T_a_b);
  graph_.add_edge({stop - 1, stop, EdgeKind::kOdometry, odometry.T_a_b, odometry.covariance});
  if (match) {
    graph_.add_edge({from, stop, EdgeKind::kSequential, T_from_stop.T_a_b, T_from_stop.covariance});
  }
  stops_[stop].covariance = geometry::compose_covariance(T_map_from, stops_[from].covariance,
                                                         T_from_stop.T_a_b, T_from_stop.covariance);
}

bool ThesisMap::recent(std::uint32_t earlier, std::uint32_t stop) const {
  return stops_[stop].path_m - stops_[earlier].path_m <= config_.recent_way_m;
}

std::vector<ThesisNeighbour> ThesisMap::neighbours(std::uint32_t stop, const Pose2& T_map_stop,
                                                   std::span<const UncertainPose> relative) const {
  std::vector<ThesisNeighbour> found;
  const ThesisStop& now = stops_[stop];
  for (std::uint32_t i = 0; i < stop; ++i) {
    const ThesisStop& before = stops_[i];
    const UncertainPose& pose = relative[i];
    if (!searchable(config_, pose)) continue;
    const Eigen::Vector3d half = search_half_width(pose.covariance, config_.search_probability,
                                                   config_.search_heading_sigmas);
    const Pose2 T_earlier_new = geometry::between(graph_.poses()[i], T_map_stop);
    const topomap::VisibleRectangle seen = seen_from(now.view, T_earlier_new, half);
    if (!overlap(seen, before.view)) continue;
    const double share = expected_share(now, before, pose, seen);
    if (share >= config_.smallest_expected_overlap || i + 1 == stop) {
      found.push_back({i, pose, share});
    }
  }
  return found;
}

double ThesisMap::expected_share(const ThesisStop& now, const ThesisStop& before,
                                 const UncertainPose& T_new_earlier,
                                 const topomap::VisibleRectangle& seen_from_earlier) const {
  if (config_.evidence != MatchEvidence::kFitness) {
    return expected_overlap(now.profile, before.outline, T_new_earlier);
  }
  if (before.landmarks_m.empty()) return 0.0;
  const auto seen =
      std::count_if(before.landmarks_m.begin(), before.landmarks_m.end(),
                    [&](const Eigen::Vector2d& p) { return contains(seen_from_earlier, p); });
  return static_cast<double>(seen) / static_cast<double>(before.landmarks_m.size());
}

bool ThesisMap::overlap_now(std::uint32_t earlier, std::uint32_t later) const {
  const Pose2 T_earlier_later = geometry::between(graph_.poses()[earlier], graph_.poses()[later]);
  return overlap(seen_from(stops_[later].view, T_earlier_later, Eigen::Vector3d::Zero()),
                 stops_[earlier].view);
}

void ThesisMap::store(std::uint32_t stop, const ThesisMatch& match) {
  store_in(solutions_, stop, match);
}

void ThesisMap::store_in(SolutionStore& store, std::uint32_t stop, const ThesisMatch& match) const {
  const double cell_m = config_.genetic.resolution_m;
  const double cell_rad = config_.genetic.resolution_rad;
  const Eigen::Matrix3d unrefined =
      Eigen::Vector3d(cell_m * cell_m, cell_m * cell_m, cell_rad * cell_rad).asDiagonal();
  std::vector<RelativeSolution> solutions{
      {match.T_earlier_new.T_a_b, match.T_earlier_new.covariance, match.result.fitness}};
  for (const MatchSolution& solution : match.result.solutions) {
    const Eigen::Vector3d off =
        geometry::difference(solution.T_reference_query, match.result.T_reference_query);
    if (std::fabs(off.x()) <= cell_m && std::fabs(off.y()) <= cell_m &&
        std::fabs(off.z()) <= cell_rad) {
      continue;
    }
    solutions.push_back({geometry::inverse(solution.T_reference_query),
                         geometry::inverse_covariance(solution.T_reference_query, unrefined),
                         std::min(solution.fitness, match.result.fitness)});
  }
  store.put(match.earlier, stop, std::move(solutions));
}

void ThesisMap::add_closure(std::uint32_t stop, const ThesisMatch& match) {
  graph_.add_edge({match.earlier, stop, EdgeKind::kRevisit, match.T_earlier_new.T_a_b,
                   match.T_earlier_new.covariance});
}

void ThesisMap::move(const std::vector<Pose2>& T_map_robot) {
  PoseGraph moved;
  for (const Pose2& pose : T_map_robot) moved.add_pose(pose);
  for (const PoseGraphEdge& edge : graph_.edges()) moved.add_edge(edge);
  graph_ = std::move(moved);
  const std::vector<UncertainPose> relative = graph_.relative_to(0);
  for (std::size_t i = 1; i < stops_.size(); ++i) stops_[i].covariance = relative[i].covariance;
  ++version_;
}

topomap::StopPose ThesisMap::pose_of(std::size_t stop) const {
  const LocalMap& map = *stops_[stop].map;
  return {map.id, map.stamp_ns, graph_.poses()[stop], stops_[stop].covariance, map.id};
}

}  // namespace topogeo::localization
