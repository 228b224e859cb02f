#include "step_sums.hpp"

#include <algorithm>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

using geometry::Pose2;

void StepSums::changed(std::uint32_t stop) {
  // The pose of a stop counts in the step after it too, which may begin the next block.
  for (const std::uint32_t touched : {stop, stop + 1}) {
    const std::uint32_t block = touched / kBlock;
    if (block >= blocks_.size()) continue;
    std::vector<Eigen::Matrix3d>& sums = blocks_[block].sums;
    if (sums.size() > touched % kBlock) sums.resize(touched % kBlock);
  }
}

Eigen::Matrix3d StepSums::sum_to(std::span<const Pose2> T_map_stop, const StepCovariance& step,
                                 std::uint32_t stop) {
  const std::uint32_t block = stop / kBlock;
  if (block >= blocks_.size()) blocks_.resize(block + 1);
  std::vector<Eigen::Matrix3d>& sums = blocks_[block].sums;
  while (sums.size() <= stop % kBlock) {
    const auto at = block * kBlock + static_cast<std::uint32_t>(sums.size());
    Eigen::Matrix3d sum = sums.empty() ? Eigen::Matrix3d::Zero().eval() : sums.back();
    if (at > 0) {
      const Pose2& before = T_map_stop[at - 1];
      const Pose2& here = T_map_stop[at];
      // The error of the step, turned from the frame of the previous stop into the map and moved to
      // the map origin: a rotation at the stop shifts the origin.
      const geometry::SinCos r = geometry::sincos(before.theta_rad);
      Eigen::Matrix3d to_origin;
      to_origin << r.cos, -r.sin, here.y_m, r.sin, r.cos, -here.x_m, 0.0, 0.0, 1.0;
      sum += to_origin * step(at) * to_origin.transpose();
    }
    sums.push_back(sum);
  }
  return sums[stop % kBlock];
}

UncertainPose StepSums::along(std::span<const Pose2> T_map_stop, const StepCovariance& step,
                              std::uint32_t from, std::uint32_t to) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const std::uint32_t first = from / kBlock;
  const std::uint32_t last = to / kBlock;
  for (std::uint32_t block = first; block < last; ++block) {
    sum += sum_to(T_map_stop, step, (block + 1) * kBlock - 1);
  }
  sum += sum_to(T_map_stop, step, to);
  sum -= sum_to(T_map_stop, step, from);
  const geometry::SinCos r = geometry::sincos(T_map_stop[from].theta_rad);
  Eigen::Matrix3d turn;
  turn << r.cos, r.sin, 0.0, -r.sin, r.cos, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d at_stop = Eigen::Matrix3d::Identity();
  at_stop(0, 2) = -T_map_stop[to].y_m;
  at_stop(1, 2) = T_map_stop[to].x_m;
  const Eigen::Matrix3d from_origin = turn * at_stop;
  return {geometry::between(T_map_stop[from], T_map_stop[to]),
          from_origin * sum * from_origin.transpose()};
}

}  // namespace topogeo::localization
