#include "odometry_steps.hpp"

#include <algorithm>
#include <cstddef>

#include <Eigen/Core>

namespace topogeo::localization {

using geometry::Pose2;

void OdometrySteps::add_none() {
  steps_.emplace_back();
}

void OdometrySteps::add(const UncertainPose& recorded) {
  const double scale = scale_.factor();
  steps_.push_back({{scaled(recorded.T_a_b, scale), recorded.covariance}, recorded.T_a_b, scale});
}

void OdometrySteps::add_gap(const UncertainPose& placed) {
  steps_.push_back({placed, std::nullopt, scale_.factor()});
}

PoseGraphEdge OdometrySteps::edge_with(const Eigen::Matrix3d& covariance,
                                       const Eigen::Matrix3d& calibrated) const {
  const std::uint32_t stop = last_stop();
  return {stop - 1, stop, EdgeKind::kOdometry, last().T_a_b, covariance, calibrated};
}

PoseGraphEdge OdometrySteps::edge() const {
  const Eigen::Matrix3d& configured = last().covariance;
  // A standing robot has no odometry error, but an edge needs a covariance that can be inverted.
  if (!steps_.back().T_recorded) return edge_with(invertible(configured), invertible(configured));
  return edge_with(invertible(monitor_.widened(configured)),
                   invertible(monitor_.expected(configured)));
}

PoseGraphEdge OdometrySteps::edge_without_match() const {
  // The last steps show little of systematic errors.
  constexpr double kLessWeight = 3.0;
  const Eigen::Matrix3d expected = kLessWeight * invertible(monitor_.expected(last().covariance));
  return edge_with(expected, expected);
}

void OdometrySteps::learn(const UncertainPose& matched) {
  monitor_.add(last(), matched);
  const std::optional<Pose2>& recorded = steps_.back().T_recorded;
  if (recorded) scale_.add(*recorded, matched);
}

bool OdometrySteps::allow(const PoseGraphEdge& match, double largest2_configured) const {
  UncertainPose expected;
  UncertainPose configured;
  for (std::uint32_t stop = match.from + 1; stop <= match.to; ++stop) {
    const UncertainPose& step = steps_[stop].T_before_stop;
    expected = compose(expected, {step.T_a_b, invertible(monitor_.expected(step.covariance))});
    configured = compose(configured, {step.T_a_b, invertible(step.covariance)});
  }
  const Eigen::Vector3d error = geometry::difference(match.T_from_to, expected.T_a_b);
  return geometry::squared_mahalanobis(error, expected.covariance + match.covariance) <=
             geometry::kMahalanobis2Of99Percent &&
         geometry::squared_mahalanobis(error, configured.covariance + match.covariance) <=
             largest2_configured;
}

std::optional<Pose2> OdometrySteps::rescaled(std::uint32_t stop) const {
  const std::optional<Pose2>& recorded = steps_[stop].T_recorded;
  if (!recorded) return std::nullopt;
  const std::size_t learned = std::min<std::size_t>(stop + OdometryScale::kMemory, last_stop());
  return scaled(*recorded, steps_[learned].scale);
}

}  // namespace topogeo::localization
