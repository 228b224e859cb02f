// Points, segments and polygons in the plane.
#pragma once

#include <span>

#include <Eigen/Core>

namespace topogeo::exchange {

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

inline double distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::sqrt((a - b).squaredNorm());
}

/// Whether two segments have a point in common.
bool segments_meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d);

/// Twice the area; positive for counter-clockwise corners.
double signed_area2(std::span<const Eigen::Vector2d> corners);

/// Whether a point lies inside, by counting the edges to its right.
bool inside(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& p);

/// Whether a segment has a point in the polygon.
bool segment_touches(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& a,
                     const Eigen::Vector2d& b);

/// Whether no two edges share a point except the corner between neighbours.
bool is_simple(std::span<const Eigen::Vector2d> corners);

/// Whether two polygons share an inner point, by their edges and corners.
bool polygons_overlap(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b);

}  // namespace topogeo::exchange
