// Covariances of stretches of the path by the steps along them, in constant time: sums over blocks
// of stops, recomputed on demand after a change.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

class StepSums {
 public:
  /// The step to this stop or its pose has changed.
  void changed(std::uint32_t stop);
  void all_changed() { blocks_.clear(); }

  /// Covariance of the step from the previous stop to this one, in the frame of the previous one.
  using StepCovariance = std::function<const Eigen::Matrix3d&(std::uint32_t stop)>;
  /// T_from_to, from <= to; the covariance to first order.
  [[nodiscard]] UncertainPose along(std::span<const geometry::Pose2> T_map_stop,
                                    const StepCovariance& step, std::uint32_t from,
                                    std::uint32_t to);

 private:
  static constexpr std::uint32_t kBlock = 32;
  /// Summed covariances of the steps in a block, as a small motion of the whole map about its
  /// origin; `sums[k]` covers the steps up to stop k of the block.
  struct Block {
    std::vector<Eigen::Matrix3d> sums;
  };
  [[nodiscard]] Eigen::Matrix3d sum_to(std::span<const geometry::Pose2> T_map_stop,
                                       const StepCovariance& step, std::uint32_t stop);

  std::vector<Block> blocks_;
};

}  // namespace topogeo::localization
