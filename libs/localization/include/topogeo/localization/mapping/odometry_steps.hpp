// The steps by odometry from stop to stop, and what the drive taught about them: their scale, and
// how far they are off (docs/algorithms.md, "Pose graph").
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/odometry_monitor.hpp"
#include "topogeo/localization/mapping/odometry_scale.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// Steps are known by the number of the stop that they lead to.
class OdometrySteps {
 public:
  /// To a stop to which nothing leads: the first of all, those of a stored map.
  void add_none();

  /// As odometry recorded it, with the configured covariance in the frame of the stop before.
  void add(const UncertainPose& recorded);

  /// To a stop to which no odometry leads, but which was placed relative to the one before: nothing
  /// of what is learned applies.
  void add_gap(const UncertainPose& placed);

  /// The last step in its learned scale; its covariance is the configured one.
  [[nodiscard]] const UncertainPose& last() const { return steps_.back().T_before_stop; }

  /// The last step for the pose graph, no more certain than configured.
  [[nodiscard]] PoseGraphEdge edge() const;

  /// The same where no match is beyond doubt: it counts as much as odometry was right over the last
  /// steps.
  [[nodiscard]] PoseGraphEdge edge_without_match() const;

  /// The last step by an accepted match of the same two stops.
  void learn(const UncertainPose& matched);

  /// Whether a match lies where odometry may have brought the robot: within 99 % as good as it was
  /// over the last steps, and within this squared Mahalanobis distance as good as it is configured.
  /// One elsewhere is a look-alike.
  [[nodiscard]] bool allow(const PoseGraphEdge& match, double largest2_configured) const;

  /// The step in the scale that was learned while it and the steps after it were driven: when it
  /// was, the first ones had none of it. Nothing where odometry recorded none.
  [[nodiscard]] std::optional<geometry::Pose2> rescaled(std::uint32_t stop) const;

 private:
  struct Step {
    UncertainPose T_before_stop{};  // in the scale that was known then
    std::optional<geometry::Pose2> T_recorded{};
    double scale = 1.0;  // as known then
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
