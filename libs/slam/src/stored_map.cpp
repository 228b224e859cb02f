#include "topogeo/slam/stored_map.hpp"

#include <stdexcept>
#include <string>

namespace topogeo::localization {

namespace {

constexpr double kMatchSigma_m = 0.02;
constexpr double kMatchSigma_rad = 0.008;
// Factor on the variance of the step between two drives, because loops connect drives.
constexpr double kWeakerBetweenDrives = 100.0;

}  // namespace

Eigen::Matrix3d usual_match_covariance() {
  return Eigen::Vector3d(kMatchSigma_m * kMatchSigma_m, kMatchSigma_m * kMatchSigma_m,
                         kMatchSigma_rad * kMatchSigma_rad)
      .asDiagonal();
}

void check(const StoredMap& map) {
  for (const PoseGraphEdge& edge : map.edges) {
    if (edge.from < edge.to && edge.to < map.maps.size()) continue;
    throw std::invalid_argument("localizer: an edge of a stored map leads from stop " +
                                std::to_string(edge.from) + " to " + std::to_string(edge.to) +
                                ", expected ascending numbers of its stops");
  }
  if (!map.maps.empty() && map.maps.size() == map.trajectory.stops.size()) return;
  throw std::invalid_argument("localizer: a stored map of " + std::to_string(map.maps.size()) +
                              " local maps and " + std::to_string(map.trajectory.stops.size()) +
                              " stops, expected equal numbers, at least one");
}

std::vector<PoseGraphEdge> edges_of(const StoredMap& map) {
  std::vector<PoseGraphEdge> edges = map.edges;
  const bool known = !edges.empty();
  const std::vector<topomap::StopPose>& stops = map.trajectory.stops;
  std::vector<bool> held(stops.size(), false);
  // Paths are composed of the steps between successive stops.
  for (const PoseGraphEdge& edge : edges) {
    if (edge.from + 1 == edge.to) held[edge.to] = true;
  }
  for (std::uint32_t i = 1; i < stops.size(); ++i) {
    if (held[i]) continue;  // also if its edges are older than its poses and lack the last ones
    const double weaker = map.maps[i].starts_drive ? kWeakerBetweenDrives : 1.0;
    edges.push_back({i - 1, i, EdgeKind::kSequential,
                     geometry::between(stops[i - 1].T_map_robot, stops[i].T_map_robot),
                     weaker * usual_match_covariance()});
  }
  if (known) return edges;
  for (const topomap::LoopClosure& loop : map.loop_closures) {
    edges.push_back({loop.earlier_id, loop.later_id, EdgeKind::kRevisit, loop.T_earlier_later,
                     usual_match_covariance()});
  }
  return edges;
}

}  // namespace topogeo::localization
