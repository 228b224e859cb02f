#include "loop/loop_closing.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/slam/loop/loop_config.hpp"

#include "loop/closing_check.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Whether the steps between the two stops of a loop can be bent to meet it.
bool fits_steps(const PoseGraph& graph, const PoseGraphEdge& loop, double fitness) {
  std::vector<LoopStep> steps;
  for (std::uint32_t stop = loop.from + 1; stop <= loop.to; ++stop) {
    for (const auto& [from, covariance] : graph.links_to(stop)) {
      if (from + 1 != stop) continue;
      const Pose2 T_before_stop = geometry::between(graph.poses()[from], graph.poses()[stop]);
      steps.push_back({{T_before_stop, covariance, 1.0}});
    }
  }
  return check_closing(steps, {loop.T_from_to, loop.covariance, fitness}).consistent;
}

}  // namespace

LoopClosing::LoopClosing(const LocalizerConfig& config)
    : unaided_correction_m_(config.unaided_correction_m),
      unaided_correction_rad_(config.unaided_correction_rad) {}

LoopClosing::Round LoopClosing::judge(PoseGraph& graph, std::span<const StopMatch> matches,
                                      std::span<const double> path_m) {
  Round round;
  for (const StopMatch& match : matches) {
    if (match.accepted()) continue;
    decide(graph, match, LoopOutcome::kGate, match.reason);
    suppose_if_plausible(match, path_m);
  }
  for (const StopMatch& match : matches) {
    if (!match.accepted()) continue;
    switch (judge_alone(graph, match)) {
      case Verdict::kRefused:
        break;
      case Verdict::kPending:
        round.pending.push_back(match.edge);
        suppose_if_plausible(match, path_m);
        break;
      case Verdict::kMoves:
        round.moves = true;
        agreement_.add_accepted(match, path_m);
        break;
      case Verdict::kAgrees:
        agreement_.add_accepted(match, path_m);
        graph.add_edge(match.edge);
        round.added.push_back(match.edge);
        break;
    }
  }
  if (accept_agreed(graph, path_m) > 0) round.moves = true;
  return round;
}

LoopClosing::Verdict LoopClosing::judge_alone(const PoseGraph& graph, const StopMatch& loop) {
  const Correction correction = correction_of(graph, loop.edge);
  // A match that contradicts its prediction is accepted only if many others agree with it.
  if (loop.surprise() > SingleLoopLimits::kMostSurprise2) {
    decide(graph, loop, LoopOutcome::kUnconfirmed, Reason::kNone);
    ++unconfirmed_;
    return Verdict::kPending;
  }
  if (far(correction)) {
    if (!fits_steps(graph, loop.edge, loop.fitness)) {
      decide(graph, loop, LoopOutcome::kNoClosing, Reason::kNone);
      return Verdict::kRefused;
    }
    if (confirm(graph, loop, correction)) {
      accept(graph, loop);
      return Verdict::kMoves;
    }
    decide(graph, loop, LoopOutcome::kUnconfirmed, Reason::kNone);
    pending_.push_back({loop, correction.motion()});
    ++unconfirmed_;
    return Verdict::kPending;
  }
  if (correction.distance_m() > SingleLoopLimits::kNoticeable_m) {
    accept(graph, loop);
    return Verdict::kMoves;
  }
  decide(graph, loop, LoopOutcome::kAccepted, Reason::kNone);
  return Verdict::kAgrees;
}

// True if a loop of another stop moves the robot to the same place. Accepts the pending loops that
// do.
bool LoopClosing::confirm(const PoseGraph& graph, const StopMatch& loop,
                          const Correction& correction) {
  const auto same_place = [&](const Pose2& T_map_corrected) {
    return !far({T_map_corrected, correction.T_map_corrected});
  };
  bool confirmed = std::any_of(waiting_.begin(), waiting_.end(), [&](const PoseGraphEdge& other) {
    return other.to != loop.edge.to &&
           same_place(correction_of(graph, other).motion() * correction.T_map_now);
  });
  std::erase_if(pending_, [&](const PendingLoop& pending) {
    return pending.match.edge.to + SingleLoopLimits::kLongestWait < loop.edge.to;
  });
  const auto agrees = [&](const PendingLoop& pending) {
    return pending.match.edge.to != loop.edge.to &&
           same_place(pending.motion * correction.T_map_now);
  };
  for (const PendingLoop& pending : pending_) {
    if (!agrees(pending)) continue;
    accept(graph, pending.match);
    confirmed = true;
  }
  std::erase_if(pending_, agrees);
  return confirmed;
}

void LoopClosing::suppose_if_plausible(const StopMatch& loop, std::span<const double> path_m) {
  if (loop.plausible()) agreement_.add(loop, path_m);
}

std::size_t LoopClosing::accept_agreed(const PoseGraph& graph, std::span<const double> path_m) {
  const std::vector<StopMatch> agreed = agreement_.accepted(graph, path_m);
  for (const StopMatch& loop : agreed) {
    std::erase_if(pending_, [&](const PendingLoop& pending) {
      return pending.match.edge.from == loop.edge.from && pending.match.edge.to == loop.edge.to;
    });
    accept(graph, loop);
  }
  return agreed.size();
}

double LoopClosing::Correction::distance_m() const {
  return std::sqrt((T_map_now.position_m() - T_map_corrected.position_m()).squaredNorm());
}

double LoopClosing::Correction::turn_rad() const {
  return std::fabs(geometry::wrap_angle(T_map_now.theta_rad - T_map_corrected.theta_rad));
}

Pose2 LoopClosing::Correction::motion() const {
  return T_map_corrected * geometry::inverse(T_map_now);
}

LoopClosing::Correction LoopClosing::correction_of(const PoseGraph& graph,
                                                   const PoseGraphEdge& loop) {
  return {graph.poses()[loop.to], graph.poses()[loop.from] * loop.T_from_to};
}

bool LoopClosing::far(const Correction& correction) const {
  return correction.distance_m() > unaided_correction_m_ ||
         correction.turn_rad() > unaided_correction_rad_;
}

void LoopClosing::accept(const PoseGraph& graph, const StopMatch& loop) {
  decide(graph, loop, LoopOutcome::kAccepted, Reason::kNone);
  waiting_.push_back(loop.edge);
}

void LoopClosing::accept_tracked(const PoseGraph& graph, const PoseGraphEdge& loop,
                                 double fitness) {
  StopMatch match;
  match.edge = loop;
  match.verdict = localization::Verdict::kAccepted;
  match.reason = Reason::kNone;
  match.fitness = fitness;
  match.agreement = AgreementWeights::kWantedAnywhere;  // with the previously tracked stops
  accept(graph, match);
}

void LoopClosing::outvote(const PoseGraph& graph, std::span<const PoseGraphEdge> loops) {
  for (const PoseGraphEdge& loop : loops) {
    const auto before =
        std::find_if(decisions_.rbegin(), decisions_.rend(), [&](const LoopDecision& decision) {
          return decision.outcome == LoopOutcome::kAccepted && decision.earlier_id == loop.from &&
                 decision.later_id == loop.to;
        });
    StopMatch match;
    match.edge = loop;
    LoopEvidence evidence;
    if (before != decisions_.rend()) {
      match.predicted = before->predicted;
      match.fitness = before->fitness;
      match.source = before->source;
      evidence = before->evidence;
    }
    evidence.contradicted = true;
    decide(graph, match, LoopOutcome::kOutvoted, Reason::kNone, evidence);
    ++outvoted_;
  }
}

std::vector<PoseGraphEdge> LoopClosing::release(std::size_t count) {
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(std::min(count, waiting_.size()));
  std::vector<PoseGraphEdge> released(waiting_.begin(), end);
  waiting_.erase(waiting_.begin(), end);
  return released;
}

void LoopClosing::decide(const PoseGraph& graph, const StopMatch& loop, LoopOutcome outcome,
                         Reason reason) {
  LoopEvidence evidence = loop.loop_evidence();
  evidence.contradicted = outcome == LoopOutcome::kNoClosing;
  decide(graph, loop, outcome, reason, evidence);
}

void LoopClosing::decide(const PoseGraph& graph, const StopMatch& loop, LoopOutcome outcome,
                         Reason reason, const LoopEvidence& evidence) {
  const Correction correction = correction_of(graph, loop.edge);
  decisions_.push_back({static_cast<std::uint32_t>(graph.poses().size() - 1), loop.edge.from,
                        loop.edge.to, outcome, reason, loop.edge.T_from_to, loop.predicted,
                        correction.distance_m(), correction.turn_rad(), loop.fitness, loop.source,
                        loop_probability(evidence), evidence});
}

}  // namespace topogeo::localization
