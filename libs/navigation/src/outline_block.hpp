// The first place on a path where a robot that is not round would touch an obstacle.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/motion_primitives.hpp"

#include "local_planner.hpp"

namespace topogeo::navigation {

/// Does the same as LocalPlanner::blocked for an outline with its headings along the path and its
/// turns on the spot.
std::optional<PathBlock> outline_block(const geometry::Footprint& footprint,
                                       std::span<const planning::PathSample> path, double from_m,
                                       const geometry::Pose2& T_map_robot,
                                       std::span<const Eigen::Vector2d> obstacles_m,
                                       double reach_m);

}  // namespace topogeo::navigation
