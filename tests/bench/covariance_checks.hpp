// Whether the covariances of matches and predictions fit the errors that they make.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/loop_decision.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"

namespace topogeo::bench {

/// Mean squared Mahalanobis distance of errors in (x, y, theta): 3 when the covariances are right,
/// more when they are too small.
struct MeanSquaredDistance {
  double sum = 0.0;
  std::size_t count = 0;

  void add(double squared_distance);
  [[nodiscard]] double mean() const;  ///< 0 without any
};

/// Of three stops i, j, k that were matched in pairs: the match of i and k against the composition
/// of the other two, by the calibrated covariances.
MeanSquaredDistance match_triangles(const localization::PoseGraph& graph);

/// Of predictions between stops 30 or more stops apart that were compared when the robot came to
/// the later one, against the reference poses (by local map id).
MeanSquaredDistance revisit_predictions(
    std::span<const localization::LoopDecision> decisions,
    std::span<const std::optional<geometry::Pose2>> T_reference_robot);

}  // namespace topogeo::bench
