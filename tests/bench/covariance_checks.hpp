// Checks whether the covariances of matches and predictions fit their errors.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::bench {

/// Mean squared Mahalanobis distance of errors in (x, y, theta): 3 when the covariances are right,
/// more when they are too small.
struct MeanSquaredDistance {
  double sum = 0.0;
  std::size_t count = 0;

  void add(double squared_distance);
  [[nodiscard]] double mean() const;  ///< 0 without any
};

/// Compares the match of stops i and k with the composition of the matches i, j and j, k, by the
/// calibrated covariances.
MeanSquaredDistance match_triangles(const localization::PoseGraph& graph);

/// Compares predictions with the reference poses (by local map id), for pairs of stops 30 or more
/// apart; each prediction is the one that was tested when the robot reached the later stop.
MeanSquaredDistance revisit_predictions(
    std::span<const localization::LoopDecision> decisions,
    std::span<const std::optional<geometry::Pose2>> T_reference_robot);

}  // namespace topogeo::bench
