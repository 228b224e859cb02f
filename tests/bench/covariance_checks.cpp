#include "covariance_checks.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include <Eigen/Core>
#include <Eigen/LU>

namespace topogeo::bench {
namespace {

using geometry::Pose2;
using localization::LoopDecision;
using localization::PoseGraphEdge;

// One wrong reference pose must not decide a mean.
constexpr double kLargestSquaredDistance = 100.0;
constexpr std::uint32_t kRevisitStops = 30;

using EdgesByStops = std::map<std::pair<std::uint32_t, std::uint32_t>, const PoseGraphEdge*>;

EdgesByStops matches_of(const localization::PoseGraph& graph) {
  EdgesByStops matches;
  for (const PoseGraphEdge& edge : graph.edges()) {
    if (edge.kind == localization::EdgeKind::kSequential) matches[{edge.from, edge.to}] = &edge;
  }
  return matches;
}

double triangle(const PoseGraphEdge& ij, const PoseGraphEdge& jk, const PoseGraphEdge& ik) {
  const Eigen::Matrix3d covariance =
      geometry::compose_covariance(ij.T_from_to, ij.for_predictions(), jk.T_from_to,
                                   jk.for_predictions()) +
      ik.for_predictions();
  return geometry::squared_mahalanobis(
      geometry::difference(ij.T_from_to * jk.T_from_to, ik.T_from_to), covariance);
}

bool was_predicted(const LoopDecision& decision) {
  return decision.outcome != localization::LoopOutcome::kOutvoted &&
         decision.step == decision.later_id &&
         decision.earlier_id + kRevisitStops <= decision.later_id &&
         !decision.predicted.covariance.isZero(0.0);
}

}  // namespace

void MeanSquaredDistance::add(double squared_distance) {
  sum += squared_distance;
  ++count;
}

double MeanSquaredDistance::mean() const {
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

MeanSquaredDistance match_triangles(const localization::PoseGraph& graph) {
  const EdgesByStops matches = matches_of(graph);
  MeanSquaredDistance distance;
  for (const auto& [stops, ik] : matches) {
    for (std::uint32_t j = stops.first + 1; j < stops.second; ++j) {
      const auto ij = matches.find({stops.first, j});
      const auto jk = matches.find({j, stops.second});
      if (ij == matches.end() || jk == matches.end()) continue;
      distance.add(triangle(*ij->second, *jk->second, *ik));
    }
  }
  return distance;
}

MeanSquaredDistance revisit_predictions(std::span<const LoopDecision> decisions,
                                        std::span<const std::optional<Pose2>> T_reference_robot) {
  MeanSquaredDistance distance;
  for (const LoopDecision& decision : decisions) {
    const std::optional<Pose2>& earlier = T_reference_robot[decision.earlier_id];
    const std::optional<Pose2>& later = T_reference_robot[decision.later_id];
    if (!earlier || !later || !was_predicted(decision)) continue;
    const Eigen::Vector3d error =
        geometry::difference(decision.predicted.T_a_b, geometry::between(*earlier, *later));
    distance.add(std::min(kLargestSquaredDistance,
                          geometry::squared_mahalanobis(error, decision.predicted.covariance)));
  }
  return distance;
}

}  // namespace topogeo::bench
