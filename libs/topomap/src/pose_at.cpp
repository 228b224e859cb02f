#include "topogeo/topomap/pose_at.hpp"

#include <algorithm>

namespace topogeo::topomap {

using geometry::Pose2;

std::optional<Pose2> pose_at(std::span<const StampedPose> poses, std::int64_t stamp_ns,
                             std::int64_t longest_gap_ns) {
  const auto after = std::ranges::lower_bound(poses, stamp_ns, {}, &StampedPose::stamp_ns);
  if (after == poses.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return after->pose;
  if (after == poses.begin()) return std::nullopt;
  const StampedPose& before = *(after - 1);
  const std::int64_t gap_ns = after->stamp_ns - before.stamp_ns;
  if (gap_ns > longest_gap_ns) return std::nullopt;
  const double share =
      static_cast<double>(stamp_ns - before.stamp_ns) / static_cast<double>(gap_ns);
  const Pose2 step = geometry::between(before.pose, after->pose);
  return before.pose * Pose2{share * step.x_m, share * step.y_m, share * step.theta_rad};
}

}  // namespace topogeo::topomap
