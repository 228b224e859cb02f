// Searches consistent poses along a loop, from candidates of its last pose back to its fixed first
// one. The search of Thesis, 7.3.1.2 (docs/algorithms.md, "Backward correction").
//
// Each pose follows from a known step back from its successor; the path with the largest summed
// fitness wins. The thesis searches depth first, which took hours for 60 poses: a drifting path is
// refused only near its end, after every combination of the poses in between. Here all paths
// advance pose by pose together, the best `beam_width` of them (a beam search); the others wait and
// are resumed when all paths in the beam have reached a dead end (backtracking). Paths are ranked
// by the fitness summed up so far minus the expected cost of meeting the first pose: with f the
// mean fitness of a step and d the Mahalanobis distance from the expected pose, about f d^2 / 2.
//
// A few known steps, 15 cm apart, cannot spread a gap of centimetres over a loop. So each step is
// tried a second time, drawn towards the expected pose as far as its own covariance and that of the
// pose suggest (one step of a smoother), with fitness f exp(-d^2 / 2) for a draw of d deviations.
// `draw = false` leaves that out, as in the thesis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/loop/loop_config.hpp"

#include "loop/relative_solution.hpp"

namespace topogeo::localization {

/// One pose of the loop as it is known before the search.
struct LoopPose {
  UncertainPose T_first_this;  ///< relative to the first pose of the loop; centre and extent of the
                               ///< region that the pose must lie in
  std::vector<RelativeSolution> steps;  ///< from the previous pose, best first; at least one
};

/// A pose that the last stop of the loop may have.
struct LoopCandidate {
  UncertainPose T_first_last;
  double fitness = 0.0;  ///< [0, 1]
};

/// A pose on a searched path, linked to the path behind it up to the last pose of the loop.
struct LoopNode {
  geometry::Pose2 T_first_pose;
  double fitness = 0.0;            ///< summed so far
  double rank = 0.0;               ///< the sum expected at the first pose
  const LoopNode* next = nullptr;  ///< node of the following pose; null at the last pose
  std::uint32_t candidate = 0;     ///< index of the candidate at which the path starts
};

/// Further condition on a path.
class LoopConstraint {
 public:
  virtual ~LoopConstraint() = default;
  /// Whether a path may contain this pose; `pose` is its index in the loop.
  [[nodiscard]] virtual bool allows(std::uint32_t pose, const LoopNode& node) const = 0;

 protected:
  LoopConstraint() = default;
  LoopConstraint(const LoopConstraint&) = default;
  LoopConstraint& operator=(const LoopConstraint&) = default;
};

enum class LoopSearchOutcome : std::uint8_t {
  kClosed = 0,
  kNoCandidates,       ///< of the last pose
  kCandidatesOutside,  ///< each lies outside its uncertainty or breaks the constraint
  kDeadEnd,            ///< some pose has no step back
  kTooMuchWork,        ///< largest_work was reached before a path was found
};

/// "closed", "no candidates", ...
const char* to_string(LoopSearchOutcome outcome);

/// Consistent poses round the loop.
struct LoopPath {
  std::vector<geometry::Pose2> T_first_pose;  ///< index as in the loop; the first is the identity
  double summed_fitness = 0.0;                ///< of the candidate and of each step
  std::uint32_t candidate = 0;                ///< index
};

struct LoopSearchResult {
  LoopSearchOutcome outcome = LoopSearchOutcome::kNoCandidates;
  std::vector<LoopPath> paths;  ///< largest summed fitness first; empty unless closed
  std::uint32_t nearest = 0;    ///< index of the reached pose that is nearest to the first one
  std::uint64_t expanded = 0;   ///< number of extensions of a path by one pose
  std::uint64_t work = 0;       ///< steps tried
  std::uint32_t backtracks = 0;
};

/// Searches poses[1], poses[2], ... from the last one back; poses[0] is the identity and not read.
/// The same input gives the same bits. Throws std::invalid_argument for fewer than two poses, a
/// pose without a step, a covariance of a pose or candidate that is not positive definite, a
/// candidate with a fitness outside [0, 1], or a configuration that allows nothing.
LoopSearchResult search_loop(std::span<const LoopPose> poses,
                             std::span<const LoopCandidate> candidates,
                             const LoopSearchConfig& config = {},
                             const LoopConstraint* constraint = nullptr);

}  // namespace topogeo::localization
