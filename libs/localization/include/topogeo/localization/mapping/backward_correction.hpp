// Backward correction (spec A7, thesis 7.3.1.2): when a cycle closes, walks back from each
// candidate of the last pose to the first pose of the loop, each pose replaced from the stored
// relative solutions of its successor, and keeps the way whose summed fitness is largest.
//
// The source walks depth first, which took hours for 60 poses: a walk that drifts is refused only
// near its end, after every combination of the poses between was tried. Here all walks advance pose
// by pose together, the best `beam_width` of them (a beam search); the rest waits and is taken up
// where all others have ended dead (backtracking). Walks are ranked by the fitness that they have
// summed up less what it will cost to meet the first pose: with f the mean fitness of a step and d
// the Mahalanobis distance from where the forward correction has the pose, about f d^2 / 2.
//
// A few stored solutions, 15 cm apart, cannot spread a gap of centimetres over a loop: half of the
// long loops of the trial ended dead. So each is offered a second time, drawn towards where the
// pose is expected as far as its own covariance and that of the pose suggest (one step of a
// smoother), its fitness f exp(-d^2 / 2) for a draw of d deviations. `draw = false` leaves that
// out, as in the source.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/thesis/field_of_view.hpp"
#include "topogeo/localization/thesis/solution_store.hpp"

namespace topogeo::localization {

struct BackwardConfig {
  std::uint32_t beam_width = 60;  ///< walks that advance together; wider finds better ways, at a
                                  ///< cost in proportion (benchmark backward/60)
  std::uint32_t waiting = 120;    ///< walks kept at each pose for backtracking
  std::uint64_t largest_work = 400'000;  ///< steps tried in all, so that a hopeless loop ends too
  double probability =
      0.99;  ///< of the ellipse whose rectangle a pose must lie in: a loop needs
             ///< all its poses inside, so 95 % of each would refuse many right ones
  double heading_sigmas = 3.0;
  double resolution_m = 0.15;  ///< of the genetic search: the spacing of the grid where nothing
  double resolution_rad = 0.034906585;  ///< overlaps, and the least half-width of an uncertainty
  std::uint32_t largest_grid = 125;     ///< poses of such a grid; a wider space has a wider spacing
  bool draw = true;
  double largest_draw2 = 9.0;     ///< squared deviations: a solution is drawn 3 of them at most
  double same_place_m = 0.03;     ///< of walks nearer to each other than this and this heading only
  double same_place_rad = 0.01;   ///< the best is needed when there are too many
  std::uint32_t ways_wanted = 3;  ///< best ways returned
  friend bool operator==(const BackwardConfig&, const BackwardConfig&) = default;
};

/// What the forward correction knows of one pose of the loop.
struct BackwardPose {
  UncertainPose T_first_this;     ///< relative to the first pose of the loop; centre and extent of
                                  ///< the uncertainty that the pose must lie in
  UncertainPose T_previous_this;  ///< by odometry
  FieldOfView view;               ///< of its map
  std::vector<std::uint32_t>
      overlaps;  ///< ids of the earlier maps that its map overlaps with there
};

/// A pose that the last map of the loop may have instead.
struct BackwardCandidate {
  std::uint32_t via = 0;  ///< id of the earlier map against which it was found
  UncertainPose T_first_last;
  double fitness = 0.0;  ///< [0, 1]
};

/// poses[k] is of the map first_id + k. The first pose keeps its place; its entry is not read but
/// for its view.
struct BackwardProblem {
  std::uint32_t first_id = 0;
  std::vector<BackwardPose> poses;
  std::vector<BackwardCandidate> candidates;
};

enum class BackwardOutcome : std::uint8_t {
  kClosed = 0,
  kNoCandidates,       ///< of the last pose
  kCandidatesOutside,  ///< each lies outside of its uncertainty or does not see the map any more
  kDeadEnd,            ///< no way back was left at some pose
  kTooMuchWork,        ///< largest_work was reached before a way was found
};

/// "closed", "no candidates", ...
const char* to_string(BackwardOutcome outcome);

/// A consistent way round the loop.
struct BackwardWay {
  std::vector<geometry::Pose2> T_first_pose;  ///< index as in BackwardProblem::poses
  double summed_fitness = 0.0;  ///< of the candidate and of the solution behind each step
  std::uint32_t candidate = 0;  ///< index into BackwardProblem::candidates
};

struct BackwardResult {
  BackwardOutcome outcome = BackwardOutcome::kNoCandidates;
  std::vector<BackwardWay> ways;  ///< largest summed fitness first; empty unless closed
  std::uint32_t nearest_id = 0;   ///< of the pose nearest to the first one that a walk reached
  std::uint64_t expanded = 0;     ///< walks that were continued by one pose
  std::uint64_t work = 0;         ///< steps tried
  std::uint32_t backtracks = 0;
};

/// The winner of 7.3.1.2 in ways.front(). The same input gives the same bits. Throws
/// std::invalid_argument for fewer than two poses, a covariance of a pose, of odometry or of a
/// candidate that is not positive definite, a fitness outside of [0, 1], a candidate via a map that
/// is not of the loop or is its last, or a configuration that allows nothing.
BackwardResult correct_backward(const BackwardProblem& problem, const SolutionStore& solutions,
                                const BackwardConfig& config = {});

/// Where a pose's map can lie relative to the previous one.
enum class StepKind : std::uint8_t {
  kMatched = 0,       ///< solution of both maps (7.22)
  kIntermediate = 1,  ///< through a map that both were matched with (7.23, 7.24)
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

/// One step along a loop: where a pose lies relative to the one before it. Best first; a step that
/// only odometry knows has one entry of fitness 0.
using LoopStep = std::vector<RelativeSolution>;

struct ClosingCheck {
  bool consistent = false;      ///< a way back along the loop exists
  double summed_fitness = 0.0;  ///< of the best way, closing and steps; 0 without one
  double best_fitness = 0.0;    ///< what the sum would be if every best solution held as it is
  BackwardOutcome outcome = BackwardOutcome::kNoCandidates;
  std::vector<geometry::Pose2> T_first_pose;  ///< of the best way, from the identity on
};

/// Whether a match of the last pose of a chain with its first one fits the steps between: the
/// backward search with the one candidate `closing` (T_first_last). The chain need not follow time:
/// any path through a pose graph will do. The uncertainty of a pose is that of the best solutions
/// before it, wide enough for the others where there are several. Views of all poses are optional
/// (empty): with them, maps of neighbours must go on overlapping. Throws like correct_backward, and
/// for a step without a solution.
ClosingCheck check_closing(std::span<const LoopStep> steps, const RelativeSolution& closing,
                           std::span<const FieldOfView> views = {},
                           const BackwardConfig& config = {});

}  // namespace topogeo::localization
