// Odometry steps from stop to stop and their learned scale and error (docs/algorithms.md, "Pose
// graph").
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/matching/odometry_monitor.hpp"
#include "topogeo/slam/pose_graph.hpp"

#include "odometry_scale.hpp"

namespace topogeo::localization {

/// Steps are numbered by the stop that they lead to.
class OdometrySteps {
 public:
  /// Adds a stop without a step: the first one of all, or one of a stored map.
  void add_none();

  /// Adds a step as recorded, with the configured covariance in the frame of the previous stop.
  void add(const UncertainPose& recorded);

  /// Adds a step without odometry to a stop that was placed relative to the previous one: nothing
  /// learned applies to it.
  void add_gap(const UncertainPose& placed);

  /// The last step in the learned scale; its covariance is the configured one.
  [[nodiscard]] const UncertainPose& last() const { return steps_.back().T_before_stop; }

  /// The last step for the pose graph, at most as certain as configured.
  [[nodiscard]] PoseGraphEdge edge() const;

  /// Like edge() for a stop without an accepted match: weighted by the errors of the last steps.
  [[nodiscard]] PoseGraphEdge edge_without_match() const;

  /// Learns from an accepted match of the same two stops as the last step.
  void learn(const UncertainPose& matched);

  /// Whether odometry allows a match: within 99 % of its errors over the last steps, and within
  /// this squared Mahalanobis distance by its configured errors. A match elsewhere is a look-alike.
  [[nodiscard]] bool allow(const PoseGraphEdge& match, double largest2_configured) const;

  /// The step in the scale learned during and after it, because the first steps were driven before
  /// a scale was known. Empty if odometry recorded no step.
  [[nodiscard]] std::optional<geometry::Pose2> rescaled(std::uint32_t stop) const;

 private:
  struct Step {
    UncertainPose T_before_stop{};  // in the scale known at that time
    std::optional<geometry::Pose2> T_recorded{};
    double scale = 1.0;  // as known at that time
  };
  [[nodiscard]] std::uint32_t last_stop() const {
    return static_cast<std::uint32_t>(steps_.size() - 1);
  }
  [[nodiscard]] PoseGraphEdge edge_with(const Eigen::Matrix3d& covariance,
                                        const Eigen::Matrix3d& calibrated) const;

  std::vector<Step> steps_;
  OdometryMonitor monitor_;
  OdometryScale scale_;
};

}  // namespace topogeo::localization
