#include "topogeo/pipeline/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/format.hpp"

#include "loop_pairs.hpp"
#include "nearest_pose.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using topomap::StampedPose;

// Relations over a longer time show whether loops were closed; their errors are also reported
// separately.
constexpr std::int64_t kFarApart_ns = 30'000'000'000;

std::string time_of(std::span<const StampedPose> poses) {
  if (poses.empty()) return "has no poses";
  return fmt::format("covers {:.3f} to {:.3f} s",
                     static_cast<double>(poses.front().stamp_ns) * 1e-9,
                     static_cast<double>(poses.back().stamp_ns) * 1e-9);
}

/// Poses of both trajectories at the same times.
struct Paired {
  std::vector<Pose2> estimate;
  std::vector<Pose2> reference;
};

Paired pair_by_time(std::span<const StampedPose> unsorted_estimate,
                    std::span<const StampedPose> unsorted_reference, std::int64_t max_apart_ns) {
  const std::vector<StampedPose> estimate = in_time_order(unsorted_estimate);
  const std::vector<StampedPose> reference = in_time_order(unsorted_reference);
  Paired paired;
  for (const StampedPose& wanted : reference) {
    const StampedPose* found = nearest_pose(estimate, wanted.stamp_ns, max_apart_ns);
    if (found == nullptr) continue;
    paired.estimate.push_back(found->pose);
    paired.reference.push_back(wanted.pose);
  }
  if (paired.estimate.size() < 3) {
    throw std::invalid_argument(fmt::format(
        "only {} poses match in time (within {:g} s), expected at least 3: the estimate {}, the "
        "reference {}",
        paired.estimate.size(), static_cast<double>(max_apart_ns) * 1e-9, time_of(estimate),
        time_of(reference)));
  }
  return paired;
}

/// The motion that aligns the estimate with the reference, by least squares of the distances: in
/// the plane the angle is that of the sums of products.
Pose2 best_alignment(const Paired& paired) {
  const auto n = static_cast<double>(paired.estimate.size());
  Eigen::Vector2d estimated_mean_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d true_mean_m = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < paired.estimate.size(); ++i) {
    estimated_mean_m += paired.estimate[i].position_m();
    true_mean_m += paired.reference[i].position_m();
  }
  estimated_mean_m /= n;
  true_mean_m /= n;
  double along_m2 = 0.0;
  double across_m2 = 0.0;
  for (std::size_t i = 0; i < paired.estimate.size(); ++i) {
    const Eigen::Vector2d a = paired.estimate[i].position_m() - estimated_mean_m;
    const Eigen::Vector2d b = paired.reference[i].position_m() - true_mean_m;
    along_m2 += a.dot(b);
    across_m2 += a.x() * b.y() - a.y() * b.x();
  }
  const Pose2 turn{0.0, 0.0, std::atan2(across_m2, along_m2)};
  const Eigen::Vector2d shift_m = true_mean_m - turn * estimated_mean_m;
  return {shift_m.x(), shift_m.y(), turn.theta_rad};
}

/// Error of the estimate of a relative pose.
struct PoseError {
  double distance_m = 0.0;
  double angle_rad = 0.0;  ///< >= 0
};

PoseError pose_error(const Pose2& estimate, const Pose2& truth) {
  return {(estimate.position_m() - truth.position_m()).norm(),
          std::fabs(geometry::wrap_angle(estimate.theta_rad - truth.theta_rad))};
}

RelativeError mean_error(const Paired& paired, std::span<const IndexPair> pairs) {
  RelativeError mean;
  for (const auto& [i, j] : pairs) {
    const PoseError error = pose_error(geometry::between(paired.estimate[i], paired.estimate[j]),
                                       geometry::between(paired.reference[i], paired.reference[j]));
    mean.mean_m += error.distance_m;
    mean.mean_rad += error.angle_rad;
  }
  mean.pairs = pairs.size();
  mean.mean_m /= static_cast<double>(mean.pairs);
  mean.mean_rad /= static_cast<double>(mean.pairs);
  return mean;
}

std::optional<RelationSpread> spread(std::span<const PoseError> errors) {
  if (errors.empty()) return std::nullopt;
  const auto n = static_cast<double>(errors.size());
  RelationSpread result;
  result.pairs = errors.size();
  for (const PoseError& error : errors) {
    result.mean_m += error.distance_m;
    result.mean_rad += error.angle_rad;
  }
  result.mean_m /= n;
  result.mean_rad /= n;
  double squared_m2 = 0.0;
  double squared_rad2 = 0.0;
  for (const PoseError& error : errors) {
    squared_m2 += (error.distance_m - result.mean_m) * (error.distance_m - result.mean_m);
    squared_rad2 += (error.angle_rad - result.mean_rad) * (error.angle_rad - result.mean_rad);
  }
  result.deviation_m = std::sqrt(squared_m2 / n);
  result.deviation_rad = std::sqrt(squared_rad2 / n);
  return result;
}

}  // namespace

TrajectoryError trajectory_error(std::span<const StampedPose> estimate,
                                 std::span<const StampedPose> reference,
                                 std::int64_t max_apart_ns) {
  const Paired paired = pair_by_time(estimate, reference, max_apart_ns);
  const std::size_t count = paired.estimate.size();
  const auto n = static_cast<double>(count);
  const Pose2 T_reference_estimate = best_alignment(paired);

  TrajectoryError error;
  error.pairs = count;
  error.matched = n / static_cast<double>(reference.size());
  double sum_m2 = 0.0;
  std::vector<IndexPair> steps;
  for (std::size_t i = 0; i < count; ++i) {
    const PoseError left =
        pose_error(T_reference_estimate * paired.estimate[i], paired.reference[i]);
    sum_m2 += left.distance_m * left.distance_m;
    error.largest_m = std::max(error.largest_m, left.distance_m);
    error.heading_rad += left.angle_rad / n;
    if (i == 0) continue;
    steps.emplace_back(i - 1, i);
    error.path_m +=
        (paired.reference[i].position_m() - paired.reference[i - 1].position_m()).norm();
  }
  error.rms_m = std::sqrt(sum_m2 / n);
  error.local = mean_error(paired, steps);
  const std::vector<IndexPair> loops = loop_pairs(paired.reference);
  if (!loops.empty()) error.loop = mean_error(paired, loops);
  error.end_m = pose_error(geometry::between(paired.estimate.front(), paired.estimate.back()),
                           geometry::between(paired.reference.front(), paired.reference.back()))
                    .distance_m;
  return error;
}

RelationsError relations_error(std::span<const StampedPose> estimate,
                               std::span<const storage::Relation> relations,
                               std::int64_t max_apart_ns) {
  const std::vector<StampedPose> poses = in_time_order(estimate);
  std::vector<PoseError> all;
  std::vector<PoseError> far;
  for (const storage::Relation& relation : relations) {
    const StampedPose* a = nearest_pose(poses, relation.stamp_a_ns, max_apart_ns);
    const StampedPose* b = nearest_pose(poses, relation.stamp_b_ns, max_apart_ns);
    if (a == nullptr || b == nullptr) continue;
    all.push_back(pose_error(geometry::between(a->pose, b->pose), relation.T_a_b));
    if (std::abs(relation.stamp_b_ns - relation.stamp_a_ns) > kFarApart_ns) {
      far.push_back(all.back());
    }
  }
  return {relations.size(), spread(all), spread(far)};
}

}  // namespace topogeo::pipeline
