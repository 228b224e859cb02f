// Backward correction (Thesis, 7.3.1.2; docs/algorithms.md, "Backward correction"): when a cycle
// closes, replaces each pose from the last one back to the first pose of the loop by the stored
// relative solutions of its successor, and keeps the poses with the largest summed fitness. The
// search itself is that of loop_search.hpp; this file adds its steps, and the condition that
// overlapping maps must still overlap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/thesis/solution_store.hpp"
#include "topogeo/thesis/thesis_config.hpp"
#include "topogeo/topomap/visible_rectangle.hpp"

#include "loop/loop_search.hpp"

namespace topogeo::localization {

/// Result of the forward correction for one pose of the loop.
struct BackwardPose {
  UncertainPose T_first_this;      ///< relative to the first pose of the loop; centre and extent of
                                   ///< the region that the pose must lie in
  UncertainPose T_previous_this;   ///< by odometry
  topomap::VisibleRectangle view;  ///< of its map
  std::vector<std::uint32_t> overlaps;  ///< ids of the earlier maps that overlap its map there
};

/// An alternative pose for the last map of the loop.
struct BackwardCandidate {
  std::uint32_t via = 0;  ///< id of the earlier map that it was matched with
  UncertainPose T_first_last;
  double fitness = 0.0;  ///< [0, 1]
};

/// poses[k] belongs to the map first_id + k. The first pose is fixed; only the view of its entry is
/// read.
struct BackwardProblem {
  std::uint32_t first_id = 0;
  std::vector<BackwardPose> poses;
  std::vector<BackwardCandidate> candidates;
};

struct BackwardResult : LoopSearchResult {
  std::uint32_t nearest_id = 0;  ///< of the map at the pose `nearest`
};

/// The winner of 7.3.1.2 in paths.front(); indices are those of the problem. The same input gives
/// the same bits. Throws std::invalid_argument like search_loop(), for a covariance of odometry
/// that is not positive definite, an overlap with a map that is not earlier, a candidate via a map
/// outside the loop or via its last one, or an empty grid.
BackwardResult correct_backward(const BackwardProblem& problem, const SolutionStore& solutions,
                                const BackwardConfig& config = {});

/// Possible origins of a step from the previous pose.
enum class StepKind : std::uint8_t {
  kMatched = 0,       ///< solution of both maps (eq. 7.22)
  kIntermediate = 1,  ///< through a map that both were matched with (eqs. 7.23, 7.24)
  kOdometry = 2,      ///< maps overlap, but no match
  kGrid = 3,          ///< nothing overlaps: a pose from the search space of the odometry
};

struct StepOption {
  StepKind kind = StepKind::kMatched;
  geometry::Pose2 T_previous_this;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< in the frame of the previous pose
  double fitness = 0.0;  ///< of the match; the smaller of two via an intermediate map; else 0
};

/// All options of poses[k], k >= 1, in order of preference: those of the first StepKind that gives
/// any.
std::vector<StepOption> step_options(const BackwardProblem& problem, const SolutionStore& solutions,
                                     const BackwardConfig& config, std::uint32_t k);

}  // namespace topogeo::localization
