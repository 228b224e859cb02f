// Probability that a match states the relative pose of two stops correctly (docs/algorithms.md,
// "Loops").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace topogeo::localization {

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

}  // namespace topogeo::localization
