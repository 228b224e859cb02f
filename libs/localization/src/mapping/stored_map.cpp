#include "topogeo/localization/mapping/stored_map.hpp"

#include <stdexcept>
#include <string>

namespace topogeo::localization {

namespace {

constexpr double kMatchSigma_m = 0.02;
constexpr double kMatchSigma_rad = 0.008;
// Of the variance of the step from one drive to the next: drives hang together by their loops.
constexpr double kWeakerBetweenDrives = 100.0;

}  // namespace

Eigen::Matrix3d usual_match_covariance() {
  return Eigen::Vector3d(kMatchSigma_m * kMatchSigma_m, kMatchSigma_m * kMatchSigma_m,
                         kMatchSigma_rad * kMatchSigma_rad)
      .asDiagonal();
}

void check(const StoredMap& map) {
  if (!map.maps.empty() && map.maps.size() == map.trajectory.stops.size()) return;
  throw std::invalid_argument("localizer: a stored map of " + std::to_string(map.maps.size()) +
                              " local maps and " + std::to_string(map.trajectory.stops.size()) +
                              " stops, expected as many, at least one");
}

std::vector<PoseGraphEdge> edges_of(const StoredMap& map) {
  std::vector<PoseGraphEdge> edges;
  const std::vector<topomap::StopPose>& stops = map.trajectory.stops;
  for (std::uint32_t i = 1; i < stops.size(); ++i) {
    const double weaker = map.maps[i].starts_drive ? kWeakerBetweenDrives : 1.0;
    edges.push_back({i - 1, i, EdgeKind::kSequential,
                     geometry::between(stops[i - 1].T_map_robot, stops[i].T_map_robot),
                     weaker * usual_match_covariance()});
  }
  for (const topomap::LoopClosure& loop : map.loop_closures) {
    edges.push_back({loop.earlier_id, loop.later_id, EdgeKind::kRevisit, loop.T_earlier_later,
                     usual_match_covariance()});
  }
  return edges;
}

}  // namespace topogeo::localization
