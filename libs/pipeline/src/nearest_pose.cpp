#include "nearest_pose.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::pipeline {
namespace {

double apart_s(const topomap::StampedPose& pose, std::int64_t stamp_ns) {
  return std::fabs(seconds(pose.stamp_ns) - seconds(stamp_ns));
}

}  // namespace

std::vector<topomap::StampedPose> in_time_order(std::span<const topomap::StampedPose> poses) {
  std::vector<topomap::StampedPose> sorted(poses.begin(), poses.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return sorted;
}

double seconds(std::int64_t stamp_ns) {
  return static_cast<double>(static_cast<long double>(stamp_ns) / 1e9L);
}

const topomap::StampedPose* nearest_pose(std::span<const topomap::StampedPose> poses,
                                         std::int64_t stamp_ns, std::int64_t max_apart_ns) {
  if (poses.empty()) return nullptr;
  const auto after = std::upper_bound(
      poses.begin(), poses.end(), stamp_ns,
      [](std::int64_t stamp, const topomap::StampedPose& pose) { return stamp < pose.stamp_ns; });
  const bool take_before =
      after == poses.end() ||
      (after != poses.begin() && apart_s(*(after - 1), stamp_ns) <= apart_s(*after, stamp_ns));
  const topomap::StampedPose& nearest = take_before ? *(after - 1) : *after;
  return apart_s(nearest, stamp_ns) <= seconds(max_apart_ns) ? &nearest : nullptr;
}

}  // namespace topogeo::pipeline
