// Decides which matches with earlier places close a loop, and records every decision. judge() is
// the entry; loop_config.hpp has all thresholds.
//
// A loop that moves the robot little is accepted at once. One that moves it far must fit the steps
// along the loop (closing_check.hpp) and stays pending until a loop of another stop moves the robot
// to the same place. Matches that are doubtful alone are accepted together, when enough of them
// agree (loop_agreement.hpp). The next optimisation removes loops that the rest contradicts
// (outvoted_loop.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/pose_graph.hpp"

#include "loop/loop_agreement.hpp"
#include "loop/stop_match.hpp"

namespace topogeo::localization {

class LoopClosing {
 public:
  /// Reads only unaided_correction_* of `config`.
  explicit LoopClosing(const LocalizerConfig& config);

  /// Effect of judge() beside the decisions.
  struct Round {
    std::vector<PoseGraphEdge> added;    ///< accepted, and part of the graph already
    std::vector<PoseGraphEdge> pending;  ///< may be matched again
    bool moves = false;  ///< more accepted loops wait for an optimisation, see waiting()
  };
  /// Decides on matches of stops with earlier places, those that their gate refused too. `path_m`:
  /// path length from the first stop to each stop.
  Round judge(PoseGraph& graph, std::span<const StopMatch> matches, std::span<const double> path_m);

  enum class Verdict : std::uint8_t {
    kRefused = 0,  ///< no poses along the loop fit it
    kPending,      ///< moves the robot far, and no other loop agrees yet
    kAgrees,       ///< accepted without moving poses: the caller adds it to the graph
    kMoves,        ///< accepted, waits for an optimisation
  };
  /// Decides on a match that passed its gate, by itself and the loops of other stops.
  Verdict judge_alone(const PoseGraph& graph, const StopMatch& loop);

  /// Accepts a loop that is known to be right, to wait for an optimisation.
  void accept(const PoseGraph& graph, const StopMatch& loop);
  /// Accepts a match with a finished map that the robot was tracked in.
  void accept_tracked(const PoseGraph& graph, const PoseGraphEdge& loop, double fitness);
  /// Records loops that an optimisation has left out.
  void outvote(const PoseGraph& graph, std::span<const PoseGraphEdge> loops);

  /// Accepted loops that wait for an optimisation, in the order of acceptance.
  [[nodiscard]] const std::vector<PoseGraphEdge>& waiting() const { return waiting_; }
  /// Removes and returns the first `count` of them, at most all.
  std::vector<PoseGraphEdge> release(std::size_t count);
  /// Forgets pending loops: they are not confirmed any more.
  void drop_pending() { pending_.clear(); }

  [[nodiscard]] const std::vector<LoopDecision>& decisions() const { return decisions_; }
  [[nodiscard]] std::uint64_t unconfirmed() const { return unconfirmed_; }
  [[nodiscard]] std::uint64_t outvoted() const { return outvoted_; }

 private:
  /// The effect of a loop on the pose of its later stop.
  struct Correction {
    geometry::Pose2 T_map_now;
    geometry::Pose2 T_map_corrected;
    [[nodiscard]] double distance_m() const;
    [[nodiscard]] double turn_rad() const;
    /// T_map_corrected * inverse(T_map_now).
    [[nodiscard]] geometry::Pose2 motion() const;
  };
  struct PendingLoop {
    StopMatch match;
    geometry::Pose2 motion;  // Correction::motion() when it became pending
  };

  /// Keeps a match that may be right together with others as a hypothesis.
  void suppose_if_plausible(const StopMatch& loop, std::span<const double> path_m);
  /// Accepts hypotheses that agree, to wait for an optimisation; returns their number.
  std::size_t accept_agreed(const PoseGraph& graph, std::span<const double> path_m);
  [[nodiscard]] static Correction correction_of(const PoseGraph& graph, const PoseGraphEdge& loop);
  [[nodiscard]] bool far(const Correction& correction) const;
  bool confirm(const PoseGraph& graph, const StopMatch& loop, const Correction& correction);
  void decide(const PoseGraph& graph, const StopMatch& loop, LoopOutcome outcome, Reason reason);
  void decide(const PoseGraph& graph, const StopMatch& loop, LoopOutcome outcome, Reason reason,
              const LoopEvidence& evidence);

  double unaided_correction_m_;
  double unaided_correction_rad_;
  LoopAgreement agreement_;
  std::vector<PendingLoop> pending_;
  std::vector<PoseGraphEdge> waiting_;
  std::vector<LoopDecision> decisions_;
  std::uint64_t unconfirmed_ = 0;
  std::uint64_t outvoted_ = 0;
};

}  // namespace topogeo::localization
