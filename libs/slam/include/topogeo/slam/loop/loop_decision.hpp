// Decisions about places that the robot may have returned to, with reasons.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/loop/loop_probability.hpp"

namespace topogeo::localization {

enum class LoopOutcome : std::uint8_t {
  kAccepted = 0,
  kGate = 1,         ///< the gate refused the match: see LoopDecision::reason
  kUnconfirmed = 2,  ///< moves the robot far, and no other loop agrees yet
  kNoClosing = 3,    ///< no poses along the loop fit its steps
  kOutvoted = 4,     ///< accepted at first; contradicted by the rest after the optimisation
};

inline constexpr std::size_t kLoopOutcomes = 5;

/// Why two stops were compared.
enum class ProposalSource : std::uint8_t {
  kPrediction = 0,  ///< their poses predict a common view
  kPlace = 1,       ///< the view over the last metres resembles an earlier place
  kWindow = 2,      ///< like kPlace, matched as a whole and not stop by stop
};

/// "prediction", "place".
const char* to_string(ProposalSource source);

/// "accepted", "match not accepted", "unconfirmed", "no consistent closing", "outvoted".
const char* to_string(LoopOutcome outcome);

struct LoopDecision {
  std::uint32_t step = 0;  ///< local map id of the stop at which it was decided; the last one also
                           ///< for decisions after the end of the log
  std::uint32_t earlier_id = 0;  ///< local map ids
  std::uint32_t later_id = 0;
  LoopOutcome outcome = LoopOutcome::kGate;
  Reason reason = Reason::kNone;    ///< of the match
  geometry::Pose2 T_earlier_later;  ///< as matched; as predicted when nothing was in common
  UncertainPose predicted;          ///< of T_earlier_later, before the match
  double correction_m = 0.0;        ///< how far the match moves the later stop in the map
  double correction_rad = 0.0;
  double fitness = 0.0;  ///< of the match, [0, 1]
  ProposalSource source = ProposalSource::kPrediction;
  double probability = 0.0;  ///< that the match is right, from all evidence; see LoopEvidence
  LoopEvidence evidence;     ///< input of `probability`; stays in this process
};

/// Outcome and reason as in reports: "accepted", "match not accepted: few inliers", ...
std::string explanation(const LoopDecision& decision);

}  // namespace topogeo::localization
