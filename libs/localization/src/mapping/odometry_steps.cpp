#include "topogeo/localization/mapping/odometry_steps.hpp"

#include <algorithm>
#include <cstddef>

#include <Eigen/Core>

#include "link_covariances.hpp"

namespace topogeo::localization {

using geometry::Pose2;

void OdometrySteps::add_none() {
  steps_.emplace_back();
  recorded_.emplace_back();
}

void OdometrySteps::add(const UncertainPose& recorded) {
  recorded_.push_back({recorded.T_a_b, scale_.factor()});
  steps_.push_back({scaled(recorded.T_a_b, scale_.factor()), recorded.covariance});
}

void OdometrySteps::add_gap(const UncertainPose& placed) {
  recorded_.push_back({std::nullopt, scale_.factor()});
  steps_.push_back(placed);
}

PoseGraphEdge OdometrySteps::edge() const {
  const UncertainPose& step = last();
  const bool driven = recorded_.back().T_before_stop.has_value();
  // A standing robot has no odometry error, but an edge needs a covariance that can be inverted.
  return {last_stop() - 1,
          last_stop(),
          EdgeKind::kOdometry,
          step.T_a_b,
          invertible(driven ? monitor_.widened(step.covariance) : step.covariance),
          invertible(driven ? monitor_.expected(step.covariance) : step.covariance)};
}

PoseGraphEdge OdometrySteps::edge_without_match() const {
  // Of systematic errors the last steps show little.
  constexpr double kLessWeight = 3.0;
  const Eigen::Matrix3d expected = kLessWeight * invertible(monitor_.expected(last().covariance));
  return {last_stop() - 1, last_stop(), EdgeKind::kOdometry, last().T_a_b, expected, expected};
}

void OdometrySteps::learn(const UncertainPose& matched) {
  monitor_.add(last(), matched);
  const std::optional<Pose2>& recorded = recorded_.back().T_before_stop;
  if (recorded) scale_.add(*recorded, matched);
}

bool OdometrySteps::allow(const PoseGraphEdge& match, double largest2_configured) const {
  UncertainPose expected;
  UncertainPose configured;
  for (std::uint32_t stop = match.from + 1; stop <= match.to; ++stop) {
    const UncertainPose& step = steps_[stop];
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
  const std::optional<Pose2>& recorded = recorded_[stop].T_before_stop;
  if (!recorded) return std::nullopt;
  const std::size_t learned = std::min<std::size_t>(stop + OdometryScale::kMemory, last_stop());
  return scaled(*recorded, recorded_[learned].scale);
}

}  // namespace topogeo::localization
