#include "loop/outvoted_loop.hpp"

#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::localization {

using geometry::Pose2;

bool is_outvoted(const PoseGraphEdge& edge, std::span<const Pose2> T_map_robot) {
  if (edge.kind != EdgeKind::kRevisit) return false;
  const Pose2 now = geometry::between(T_map_robot[edge.from], T_map_robot[edge.to]);
  return geometry::squared_mahalanobis(geometry::difference(now, edge.T_from_to), edge.covariance) >
         OutvotedLoopLimits::kOutvoted2;
}

}  // namespace topogeo::localization
