#include <algorithm>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"

namespace topogeo::localization {

namespace {

using Kind = LoopEvidence::Kind;

// Fitted to 37,000 decisions of nine logs and five synthetic floors, each with the same weight:
// `topogeo_loops --floors 12 --reliability` prints them, and the reliability of the probabilities
// on logs outside the fit (docs/decisions/loop_probability.md). They define the meaning of the
// number, so none is a setting. The last one is from an earlier fit: none of these decisions is
// contradicted any more.
constexpr LoopTerms kFitted{4.13, 4.34,  4.41, 1.09,  3.80, -1.53,
                            3.66, -1.42, 0.92, -1.55, 1.05, -0.90};

// Upper limit for a position that the scans do not determine at all.
constexpr double kUnknown_m = 1.0;

}  // namespace

LoopTerms loop_terms(const LoopEvidence& e) {
  const auto of = [&](Kind kind) { return e.kind == kind ? 1.0 : 0.0; };
  const double window = of(Kind::kWindow);
  const double stop = 1.0 - window;
  // A match that passed its gate is right wherever it was predicted: one of 22,000 was wrong.
  const double unproved = 1.0 - of(Kind::kPassed);
  const double surprise = unproved * geometry::log(1.0 + e.surprise);
  const double unknown_m = std::min(kUnknown_m, e.weakest_sigma_m);
  return {of(Kind::kPassed), of(Kind::kDoubtful), of(Kind::kRefused), window, stop * e.inliers,
          stop * e.rivalry, window * e.fitness, surprise, unproved * unknown_m,
          // Where the scans allow any place along a corridor, the prediction decides.
          unknown_m * surprise, e.agreement > 0.0 ? 1.0 : 0.0, e.contradicted ? 1.0 : 0.0};
}

double loop_probability(const LoopEvidence& evidence, const LoopTerms& coefficients) {
  if (evidence.kind == Kind::kNone) return 0.0;
  const LoopTerms terms = loop_terms(evidence);
  double log_odds = 0.0;
  for (std::size_t i = 0; i < kLoopTerms; ++i) log_odds += coefficients[i] * terms[i];
  return 1.0 / (1.0 + geometry::exp(-log_odds));
}

double loop_probability(const LoopEvidence& evidence) {
  return loop_probability(evidence, kFitted);
}

}  // namespace topogeo::localization
