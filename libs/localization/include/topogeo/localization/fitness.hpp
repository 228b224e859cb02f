// How well two local maps agree at a relative pose (spec A5, thesis 6.2.5).
//
// The printed fitness averages over equivalent elements only, so it rewards a pose at which few
// elements are equivalent, and its orientation factor is zero for parallel branches. Here each
// element of the query map scores a soft kernel of its distance to the nearest equivalent element
// of the reference map, times kernels of the difference in clearance and in direction (1 when
// aligned, undirected), and an element without a partner scores 0: the mean over *all* elements
// therefore counts coverage.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/match.hpp"
#include "topogeo/localization/match_features.hpp"
#include "topogeo/localization/nearest_point_grid.hpp"

namespace topogeo::localization {

/// Features of the reference map together with the look-up grids on them.
struct Reference {
  MatchFeatures features;
  NearestPointGrid surface_grid;  ///< on features.surface
  NearestPointGrid branch_grid;   ///< on features.branches
};

Reference make_reference(MatchFeatures features);

class Fitness {
 public:
  /// Keeps references to both maps. `task` gives the form and the odometry prior.
  Fitness(const Reference& reference, const MatchFeatures& query, const MatchTask& task);

  /// Fitness in [0, 1] at T_reference_query. No allocation.
  [[nodiscard]] double operator()(const geometry::Pose2& T_reference_query) const;

  /// The parts of it, for reports and tests; each in [0, 1].
  [[nodiscard]] double topological(const geometry::Pose2& T_reference_query) const;
  [[nodiscard]] double scan(const geometry::Pose2& T_reference_query) const;
  [[nodiscard]] double prior(const geometry::Pose2& T_reference_query) const;

 private:
  const Reference& reference_;
  const MatchFeatures& query_;
  FitnessForm form_;
  geometry::Pose2 T_prior_;
  Eigen::Matrix3d information_;
};

}  // namespace topogeo::localization
