// Backward correction (Thesis, 7.3.1.2; docs/algorithms.md, "Backward correction"): when a cycle
// closes, replaces each pose from the last one back to the first pose of the loop by the stored
// relative solutions of its successor, and keeps the poses whose summed fitness is largest. The
// search itself is that of loop_search.hpp; here are the steps that it may take and the condition
// that maps which overlapped go on overlapping.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/loop_search.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/thesis/backward_config.hpp"
#include "topogeo/localization/thesis/solution_store.hpp"
#include "topogeo/localization/thesis/visible_rectangle.hpp"

namespace topogeo::localization {

/// What the forward correction knows of one pose of the loop.
struct BackwardPose {
  UncertainPose T_first_this;     ///< relative to the first pose of the loop; centre and extent of
                                  ///< the uncertainty that the pose must lie in
  UncertainPose T_previous_this;  ///< by odometry
  VisibleRectangle view;          ///< of its map
  std::vector<std::uint32_t>
      overlaps;  ///< ids of the earlier maps that its map overlaps with there
};

/// A pose that the last map of the loop may have instead.
struct BackwardCandidate {
  std::uint32_t via = 0;  ///< id of the earlier map against which it was found
  UncertainPose T_first_last;
  double fitness = 0.0;  ///< [0, 1]
};

/// poses[k] is of the map first_id + k. The first pose keeps its place; only the view of its entry
/// is read.
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
/// that is not of the loop or is its last, or a grid of no pose.
BackwardResult correct_backward(const BackwardProblem& problem, const SolutionStore& solutions,
                                const BackwardConfig& config = {});

/// Where a pose's map can lie relative to the previous one.
enum class StepKind : std::uint8_t {
  kMatched = 0,       ///< solution of both maps (eq. 7.22)
  kIntermediate = 1,  ///< through a map that both were matched with (eqs. 7.23, 7.24)
  kOdometry = 2,      ///< overlapping maps, but nothing matches
  kGrid = 3,          ///< nothing overlaps: a place of the odometry's search space
};

struct StepOption {
  StepKind kind = StepKind::kMatched;
  geometry::Pose2 T_previous_this;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< in the frame of the previous pose
  double fitness = 0.0;  ///< of the match; the poorer of two through an intermediate map; else 0
};

/// All options of poses[k], k >= 1, in the order in which they are preferred: those of the first
/// kind above that gives any.
std::vector<StepOption> step_options(const BackwardProblem& problem, const SolutionStore& solutions,
                                     const BackwardConfig& config, std::uint32_t k);

}  // namespace topogeo::localization
