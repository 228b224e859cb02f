#include "link_covariances.hpp"

#include <optional>

namespace topogeo::localization {

Eigen::Matrix3d best_link_to(const PoseGraph& graph, std::uint32_t stop) {
  std::optional<Eigen::Matrix3d> best;
  for (const auto& [from, covariance] : graph.links_to(stop)) {
    if (!best || PoseGraph::path_cost(covariance) < PoseGraph::path_cost(*best)) best = covariance;
  }
  return best.value();  // odometry always leads here
}

Eigen::Matrix3d covariance_in_map(const PoseGraph& graph,
                                  std::span<const Eigen::Matrix3d> covariances,
                                  std::uint32_t stop) {
  std::optional<Eigen::Matrix3d> best;
  for (const auto& [from, link] : graph.links_to(stop)) {
    const Eigen::Matrix3d covariance = geometry::compose_covariance(
        graph.poses()[from], covariances[from],
        geometry::between(graph.poses()[from], graph.poses()[stop]), link);
    if (!best || PoseGraph::path_cost(covariance) < PoseGraph::path_cost(*best)) best = covariance;
  }
  return best.value();
}

}  // namespace topogeo::localization
