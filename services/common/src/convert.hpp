// Checks and conversions shared by several message types.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/msg/common.h"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::service::detail {

/// Largest number of segments of a trajectory and its companions: the number of instances that
/// readers of these topics keep (deploy/dds_profiles.xml, state_reader). Receivers keep all
/// segments.
inline constexpr std::uint32_t kMostSegments = 32'768;

/// Throws std::invalid_argument unless `size` fits the bound of the field.
inline void check_bound(std::string_view field, std::size_t size, std::size_t bound) {
  if (size <= bound) return;
  throw std::invalid_argument(std::string(field) + " has " + std::to_string(size) +
                              " entries, expected at most " + std::to_string(bound));
}

/// Throws std::invalid_argument unless `condition`; `expected` is its text.
inline void check(bool condition, std::string_view field, std::string_view expected) {
  if (!condition) {
    throw std::invalid_argument(std::string(field) + ": expected " + std::string(expected));
  }
}

inline void check_segment(std::uint32_t segment) {
  check(segment < kMostSegments, "segment", "less than " + std::to_string(kMostSegments));
}

inline double finite(double value, std::string_view field) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(std::string(field) + " is " + std::to_string(value) +
                                ", expected a finite number");
  }
  return value;
}

inline msg::NodeKind to_msg(topomap::NodeKind kind) {
  return static_cast<msg::NodeKind>(kind);  // same values, see common.idl
}

inline topomap::NodeKind from_msg(msg::NodeKind kind) {
  check(static_cast<std::uint32_t>(kind) <= msg::kNodeHallCorridor, "node kind", "0 to 5");
  return static_cast<topomap::NodeKind>(kind);
}

inline msg::Point2 to_point(const Eigen::Vector2d& position_m) {
  msg::Point2 point;
  point.x_m(position_m.x());
  point.y_m(position_m.y());
  return point;
}

inline msg::BranchPoint to_branch_point(const Eigen::Vector2d& position_m, double clearance_m) {
  msg::BranchPoint point;
  point.x_m(position_m.x());
  point.y_m(position_m.y());
  point.clearance_m(clearance_m);
  return point;
}

inline topomap::BranchPoint from_branch_point(const msg::BranchPoint& point,
                                              std::string_view field) {
  return {{finite(point.x_m(), field), finite(point.y_m(), field)},
          finite(point.clearance_m(), field)};
}

inline std::vector<msg::BranchPoint> to_branch_points(
    const std::vector<topomap::BranchPoint>& points, std::string_view field) {
  check_bound(field, points.size(), msg::kMaxBranchPoints);
  std::vector<msg::BranchPoint> out;
  out.reserve(points.size());
  for (const topomap::BranchPoint& point : points) {
    out.push_back(to_branch_point(point.position_m, point.clearance_m));
  }
  return out;
}

inline std::vector<topomap::BranchPoint> from_branch_points(
    const std::vector<msg::BranchPoint>& points, std::string_view field) {
  check(points.size() >= 2, field, "at least 2 points");
  std::vector<topomap::BranchPoint> out;
  out.reserve(points.size());
  for (const msg::BranchPoint& point : points) out.push_back(from_branch_point(point, field));
  return out;
}

}  // namespace topogeo::service::detail
