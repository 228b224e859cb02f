// Decides whether the result of a match is believed. Every match passes through here, the ones with
// the stop just before too: a single poor match in a turn costs more than all the good ones give.
#pragma once

#include <cstdint>

#include "topogeo/localization/match.hpp"

namespace topogeo::localization {

struct GateConfig {
  double smallest_overlap = 0.20;  ///< share of the query's points in the reference's view
  double smallest_inliers = 0.50;  ///< of those, share on a surface
  double largest_doubt = 2.2;      ///< see doubt()
  double doubt_per_search_m =
      0.25;  ///< less is allowed for a wider search, where look-alikes are likelier
  double largest_mahalanobis2 = 25.0;  ///< between the result and the prediction (3 d.o.f.)
  double largest_ambiguity = 0.95;  ///< fitness of the second best distinct solution over the best
};

/// One number for how much speaks against a match: 0 for a perfect one, above 2 hardly any is
/// right. Space that one scan saw free and the other occupied weighs most, then points without a
/// partner, large residuals and a low scan fitness. Each part alone rejects too many good matches
/// of sparse or cluttered scans.
double doubt(const MatchResult& result);

enum class Verdict : std::uint8_t {
  kAccepted = 0,
  kNothingInCommon,
  kLittleOverlap,
  kFewInliers,
  kDoubtful,
  kImplausible,
  kAmbiguous,
};

inline constexpr std::size_t kVerdicts = 7;

/// Short English words for a verdict, as in reports: "accepted", "little overlap", ...
const char* to_string(Verdict verdict);

Verdict judge(const MatchTask& task, const MatchResult& result, const GateConfig& config);

/// Covariance of T_reference_query from the data alone, in the reference frame, wider the more
/// doubtful the match, with a floor for what the least squares does not know (correlated beams,
/// thick walls): 2 cm and 0.3 degrees.
Eigen::Matrix3d match_covariance(const MatchResult& result);

}  // namespace topogeo::localization
