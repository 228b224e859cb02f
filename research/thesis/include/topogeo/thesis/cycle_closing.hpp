// Closes cycles by the backward correction (Thesis, 7.3.1.2; docs/algorithms.md, "Backward
// correction"): finds the maps that are seen again, the last pose that they measure, and its effect
// on the poses since.
//
// Differences from the print, with reasons:
// - a recent map that returns to the overlap set (it flickers at the threshold) closes no cycle;
// - the correction ends at the oldest of the maps seen again, because a candidate carries no
//   information about the poses before it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/thesis/backward_correction.hpp"
#include "topogeo/thesis/kept_solutions.hpp"
#include "topogeo/thesis/thesis_config.hpp"
#include "topogeo/thesis/thesis_map.hpp"
#include "topogeo/thesis/thesis_matching.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// A backward correction that closed a cycle.
struct ClosedCycle {
  BackwardProblem problem;
  BackwardResult found;  ///< paths.front() became the poses
};

class CycleClosing {
 public:
  /// Reads from `config`: revisit_matches (maps seen again that are matched per step; 0: cycles
  /// stay open), unaided_correction_* and thesis, whose backward correction has the resolution of
  /// the genetic search.
  explicit CycleClosing(const ThesisSlamConfig& config) : config_(config) {}

  /// Closes the cycles of the last stop, whose pose by the forward correction is known. Repeats
  /// matching and correction, because other maps may overlap once a cycle has closed. True if poses
  /// moved.
  bool close(ThesisMap& map, ThesisMatching& matching);

  /// Distinct solutions for the last stop, whose pose by the forward correction is known: one
  /// backward correction for each of the fittest poses that maps seen again give it. Poses of `map`
  /// do not change, and no closure is added. Reads thesis.cycle_candidates, too.
  std::vector<CycleSolution> solutions(const ThesisMap& map, ThesisMatching& matching);

  [[nodiscard]] const std::vector<topomap::LoopClosure>& closures() const { return closures_; }
  [[nodiscard]] const std::vector<LoopDecision>& decisions() const { return decisions_; }
  /// The last closed cycle, for inspection.
  [[nodiscard]] const std::optional<ClosedCycle>& last_closing() const { return last_closing_; }
  /// Number of backward corrections, and of those without consistent poses.
  [[nodiscard]] std::uint64_t attempts() const { return attempts_; }
  [[nodiscard]] std::uint64_t failures() const { return failures_; }

 private:
  [[nodiscard]] std::vector<ThesisNeighbour> seen_again(ThesisMap& map,
                                                        std::span<const std::uint32_t> tried) const;
  bool close_with(ThesisMap& map, ThesisMatching& matching,
                  std::span<const ThesisNeighbour> seen_again);
  void accept(ThesisMap& map, std::span<const ThesisMatch> matches, std::uint32_t winner,
              const geometry::Pose2& T_map_before);
  void decide(const ThesisMap& map, const ThesisMatch& match, LoopOutcome outcome,
              const geometry::Pose2& T_map_before);

  ThesisSlamConfig config_;
  std::vector<topomap::LoopClosure> closures_;
  std::vector<LoopDecision> decisions_;
  std::optional<ClosedCycle> last_closing_;
  std::uint64_t attempts_ = 0;
  std::uint64_t failures_ = 0;
};

}  // namespace topogeo::localization
