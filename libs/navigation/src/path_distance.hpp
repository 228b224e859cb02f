// Distance of a point from a path.
#pragma once

#include <span>

#include <Eigen/Core>

#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

/// Distance from a point to the nearest sample of a path; infinity for an empty one.
double distance_m(std::span<const planning::PathSample> path, const Eigen::Vector2d& point_m);

}  // namespace topogeo::navigation
