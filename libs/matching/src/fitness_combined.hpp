// The fitness for localization: a mean of the topological form and the agreement of the scan
// points, times the likelihood of the pose by odometry.
//
// Nodes and branches show which places are alike, scan points how well one lies on the other.
// Without the odometry both lead to look-alikes.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "topogeo/matching/fitness_forms.hpp"

#include "fitness_points.hpp"
#include "fitness_topological.hpp"

namespace topogeo::localization {

/// Mean over the query's thinned scan points of a soft kernel of the distance to the nearest point
/// of the reference; a point seen from the other side counts 0.
class ScanFitness : public Fitness {
 public:
  /// bind() before use.
  ScanFitness() = default;
  ScanFitness(const Reference& reference, const MatchFeatures& query) { bind(reference, query); }

  /// Both must outlive their use. Allocates only for more points than ever before.
  void bind(const Reference& reference, const MatchFeatures& query);

  [[nodiscard]] double at(const geometry::Pose2& T_reference_query,
                          const geometry::SinCos& heading) const override;

 private:
  const Reference* reference_ = nullptr;
  LaneArray x_m_;
  LaneArray y_m_;
  LaneArray normal_x_;
  LaneArray normal_y_;
  double per_point_ = 0.0;
};

/// 1 at the predicted pose, falling with the Mahalanobis distance from it but never to 0, so that
/// an optimistic odometry covariance cannot veto the scans.
class OdometryPrior {
 public:
  /// bind() before use.
  OdometryPrior() = default;
  explicit OdometryPrior(const MatchTask& task) { bind(task); }
  void bind(const MatchTask& task);

  /// In (0, 1] at T_reference_query.
  [[nodiscard]] double operator()(const geometry::Pose2& T_reference_query) const;

 private:
  geometry::Pose2 T_predicted_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
};

class CombinedFitness : public Fitness {
 public:
  /// bind() before use.
  CombinedFitness() = default;
  CombinedFitness(const Reference& reference, const MatchFeatures& query, const MatchTask& task) {
    bind(reference, query, task);
  }

  /// The maps must outlive their use. Allocates only for a larger map than ever before.
  void bind(const Reference& reference, const MatchFeatures& query, const MatchTask& task);

  [[nodiscard]] double at(const geometry::Pose2& T_reference_query,
                          const geometry::SinCos& heading) const override;

  /// The fitness of a pose by the maps alone, without the odometry.
  [[nodiscard]] double of_maps(const geometry::Pose2& T_reference_query,
                               const geometry::SinCos& heading) const;

  /// The parts of it.
  [[nodiscard]] const TopologicalFitness& topological() const { return topological_; }
  [[nodiscard]] const ScanFitness& scan() const { return scan_; }
  [[nodiscard]] const OdometryPrior& prior() const { return prior_; }

 private:
  TopologicalFitness topological_;
  ScanFitness scan_;
  OdometryPrior prior_;
};

}  // namespace topogeo::localization
