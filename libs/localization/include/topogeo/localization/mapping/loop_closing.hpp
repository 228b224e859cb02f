// Decides which matches with earlier places close a loop, and records every decision.
//
// A loop that moves the robot little is accepted at once. One that moves it far must fit the steps
// along the loop (closing_check.hpp), and a loop of another stop must move the robot to the same
// place; until then it is pending.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/loop_agreement.hpp"
#include "topogeo/localization/mapping/loop_decision.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/stop_match.hpp"

namespace topogeo::localization {

class LoopClosing {
 public:
  /// Of `config` it reads unaided_correction_*.
  explicit LoopClosing(const LocalizerConfig& config);

  enum class Verdict : std::uint8_t {
    kRefused = 0,  ///< no poses along the loop fit it
    kPending,      ///< moves the robot far and nothing agrees with it so far
    kAgrees,       ///< accepted, and the poses need not move: the caller adds it to the graph
    kMoves,        ///< accepted, and waiting for an optimisation
  };
  /// Decides on a match of the last stop, or of any after the end of a log, that passed its gate.
  Verdict consider(const PoseGraph& graph, const StopMatch& loop);

  /// Keeps a match, of whatever verdict, that may be right together with others.
  void suppose(const StopMatch& loop, std::span<const double> path_m) {
    agreement_.add(loop, path_m);
  }
  /// Tells those supposed of a loop that was accepted alone.
  void support(const StopMatch& loop, std::span<const double> path_m) {
    agreement_.add_accepted(loop, path_m);
  }
  /// Accepts those supposed loops that agree, to wait for an optimisation; returns how many.
  std::size_t accept_agreed(const PoseGraph& graph, std::span<const double> path_m);

  /// Records a match that its gate refused.
  void refuse(const PoseGraph& graph, const StopMatch& loop);
  /// Accepts a loop that is known to be right, to wait for an optimisation.
  void accept(const PoseGraph& graph, const StopMatch& loop);
  /// Records loops that an optimisation has left out.
  void outvote(const PoseGraph& graph, std::span<const PoseGraphEdge> loops);

  /// Accepted loops that wait for an optimisation, in the order of acceptance.
  [[nodiscard]] const std::vector<PoseGraphEdge>& waiting() const { return waiting_; }
  /// Gives away the first of them, at most all.
  std::vector<PoseGraphEdge> release(std::size_t count);
  /// Pending loops are not confirmed any more.
  void drop_pending() { pending_.clear(); }

  [[nodiscard]] const std::vector<LoopDecision>& decisions() const { return decisions_; }
  [[nodiscard]] std::uint64_t unconfirmed() const { return unconfirmed_; }
  [[nodiscard]] std::uint64_t outvoted() const { return outvoted_; }

 private:
  /// What a loop does to the pose of its later stop.
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
    geometry::Pose2 motion;  // see Correction, at that time
  };

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
