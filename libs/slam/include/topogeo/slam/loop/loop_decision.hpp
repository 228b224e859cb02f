// Decisions about places that the robot may have returned to, with reasons.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

// Probability that a match states the relative pose of two stops correctly (docs/algorithms.md,
// "Loops").

/// State of a match when it is decided whether it closes a loop.
struct LoopEvidence {
  enum class Kind : std::uint8_t {
    kNone = 0,  ///< nothing in common: there is no match
    kPassed,    ///< its gate let it pass
    kDoubtful,  ///< its gate was in doubt, or another pose fits nearly as well
    kRefused,   ///< its gate refused it
    kWindow,    ///< several stops matched as a whole
  };
  Kind kind = Kind::kNone;
  double fitness = 0.0;  ///< [0, 1]
  double doubt = 0.0;    ///< see doubt()
  double overlap = 0.0;  ///< [0, 1], as `inliers`
  double inliers = 0.0;
  double rivalry = 0.0;          ///< see rivalry()
  double weakest_sigma_m = 0.0;  ///< along the direction that the scans determine worst
  double surprise = 0.0;         ///< squared Mahalanobis distance from the prediction
  double agreement = 0.0;        ///< weight of the set it was accepted with; 0: accepted alone
  double rival_agreement = 0.0;  ///< of the heaviest set that contradicts that set
  bool contradicted = false;     ///< by the steps along the loop or by an optimisation
};

/// Terms of the log odds: four kinds, inliers and rivalry of a match of two stops, fitness of a
/// window, logarithm of the surprise, deviation in metres along the weakest direction, their
/// product, agreement, contradiction.
inline constexpr std::size_t kLoopTerms = 12;
using LoopTerms = std::array<double, kLoopTerms>;
LoopTerms loop_terms(const LoopEvidence& evidence);

/// Probability that the match is within 0.5 m and 10 degrees of the truth, (0, 1); 0 where nothing
/// is in common.
double loop_probability(const LoopEvidence& evidence);
/// The same with coefficients other than the fitted ones (tests/bench/loops.cpp).
double loop_probability(const LoopEvidence& evidence, const LoopTerms& coefficients);

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
