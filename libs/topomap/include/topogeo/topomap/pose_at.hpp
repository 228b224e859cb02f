// Pose of a robot at a time between two poses of its trajectory.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::topomap {

/// Interpolated on the straight line between the two poses, in proportion to time. Empty before the
/// first pose, after the last one and between two that are more than `longest_gap_ns` apart.
/// `poses` are in time order.
std::optional<geometry::Pose2> pose_at(
    std::span<const StampedPose> poses, std::int64_t stamp_ns,
    std::int64_t longest_gap_ns = std::numeric_limits<std::int64_t>::max());

}  // namespace topogeo::topomap
