// Uncertainty of a stop's pose, by its links to earlier ones.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

/// The smallest covariance among all links from earlier stops to a stop, relative to the earlier
/// stop. The stop must have such a link.
Eigen::Matrix3d best_link_to(const PoseGraph& graph, std::uint32_t stop);

/// The same in the map frame, through the covariances of the earlier stops.
Eigen::Matrix3d covariance_in_map(const PoseGraph& graph,
                                  std::span<const Eigen::Matrix3d> covariances, std::uint32_t stop);

}  // namespace topogeo::localization
