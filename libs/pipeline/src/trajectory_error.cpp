#include "topogeo/pipeline/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::pipeline {
namespace {

using topomap::StampedPose;

std::int64_t apart_ns(const StampedPose& a, const StampedPose& b) {
  return std::abs(a.stamp_ns - b.stamp_ns);
}

/// The pose nearest in time; `poses` is not empty.
const StampedPose& nearest(std::span<const StampedPose> poses, const StampedPose& wanted) {
  const auto after = std::lower_bound(
      poses.begin(), poses.end(), wanted,
      [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns < b.stamp_ns; });
  if (after == poses.end()) return poses.back();
  if (after == poses.begin()) return *after;
  return apart_ns(*(after - 1), wanted) <= apart_ns(*after, wanted) ? *(after - 1) : *after;
}

}  // namespace

TrajectoryError trajectory_error(std::span<const StampedPose> estimate,
                                 std::span<const StampedPose> truth, std::int64_t max_apart_ns) {
  std::vector<std::pair<geometry::Pose2, geometry::Pose2>> pairs;  // estimate, truth
  for (const StampedPose& t : truth) {
    if (estimate.empty()) break;
    const StampedPose& e = nearest(estimate, t);
    if (apart_ns(e, t) <= max_apart_ns) pairs.emplace_back(e.pose, t.pose);
  }
  if (pairs.size() < 3) {
    throw std::invalid_argument("only " + std::to_string(pairs.size()) +
                                " poses match in time, expected at least 3");
  }

  const auto n = static_cast<Eigen::Index>(pairs.size());
  Eigen::MatrixXd estimated_m(2, n);  // with rows fixed to 2 GCC warns inside of umeyama
  Eigen::MatrixXd true_m(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [e, t] = pairs[static_cast<std::size_t>(i)];
    estimated_m.col(i) << e.x_m, e.y_m;
    true_m.col(i) << t.x_m, t.y_m;
  }
  const Eigen::MatrixXd T = Eigen::umeyama(estimated_m, true_m, false);
  const geometry::Pose2 T_truth_estimate{T(0, 2), T(1, 2), std::atan2(T(1, 0), T(0, 0))};

  TrajectoryError error;
  error.pairs = pairs.size();
  double sum_m2 = 0.0;
  for (const auto& [e, t] : pairs) {
    const geometry::Pose2 aligned = T_truth_estimate * e;
    const double error_m2 = (aligned.position_m() - t.position_m()).squaredNorm();
    sum_m2 += error_m2;
    error.largest_m = std::max(error.largest_m, std::sqrt(error_m2));
    error.heading_rad += std::fabs(geometry::wrap_angle(aligned.theta_rad - t.theta_rad));
  }
  error.rms_m = std::sqrt(sum_m2 / static_cast<double>(n));
  error.heading_rad /= static_cast<double>(n);
  return error;
}

}  // namespace topogeo::pipeline
