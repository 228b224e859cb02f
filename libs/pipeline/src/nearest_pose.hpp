// The pose of a trajectory nearest to a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::pipeline {

std::vector<topomap::StampedPose> in_time_order(std::span<const topomap::StampedPose> poses);

/// The double nearest to a time in seconds, as compared by other tools. Rounded by up to a quarter
/// of a microsecond, which decides whether a pose at the very limit has a partner.
double seconds(std::int64_t stamp_ns);

/// The pose nearest to a time if it is near enough, the earlier of two equally near ones; null if
/// there is none. `poses` are in time order.
const topomap::StampedPose* nearest_pose(std::span<const topomap::StampedPose> poses,
                                         std::int64_t stamp_ns, std::int64_t max_apart_ns);

}  // namespace topogeo::pipeline
