#include <algorithm>
#include <stdexcept>
#include <string>

#include "topogeo/slam/stored_map.hpp"

namespace topogeo::localization {

UncertainPose first_stop_of_drive(const PoseGraph& map,
                                  std::span<const std::shared_ptr<const topomap::LocalMap>> drive,
                                  std::span<const StoredMatch> matches_of_last,
                                  const OdometryNoise& noise) {
  if (drive.empty() || matches_of_last.empty() || map.poses().empty()) {
    throw std::invalid_argument(
        "localizer: a drive joins a map by at least one stop and one match");
  }
  UncertainPose T_first_last;
  for (std::size_t i = 1; i < drive.size(); ++i) {
    T_first_last =
        compose(T_first_last, odometry_between_stops(drive[i - 1]->T_odom_robot, *drive[i], noise));
  }
  const StoredMatch& best = *std::min_element(
      matches_of_last.begin(), matches_of_last.end(), [](const auto& a, const auto& b) {
        return PoseGraph::path_cost(a.T_stop_robot.covariance) <
               PoseGraph::path_cost(b.T_stop_robot.covariance);
      });
  if (best.stop >= map.poses().size()) {
    throw std::invalid_argument("localizer: a match with stop " + std::to_string(best.stop) +
                                " of a map of " + std::to_string(map.poses().size()) + " stops");
  }
  const auto end = static_cast<std::uint32_t>(map.poses().size() - 1);
  const UncertainPose T_end_stop = map.relative_to(end).at(best.stop);
  return compose(T_end_stop, compose(best.T_stop_robot, inverse(T_first_last)));
}

PoseGraphEdge loop_of(const StoredMatch& match, std::uint32_t last_id) {
  return {match.stop, last_id, EdgeKind::kRevisit, match.T_stop_robot.T_a_b,
          match.T_stop_robot.covariance};
}

bool contains_like(std::span<const PoseGraphEdge> edges, const PoseGraphEdge& edge) {
  return std::any_of(edges.begin(), edges.end(), [&](const PoseGraphEdge& other) {
    return other.kind == edge.kind && other.from == edge.from && other.to == edge.to;
  });
}

}  // namespace topogeo::localization
