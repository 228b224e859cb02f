// Whether a match may be right together with others that agree with it.
#pragma once

#include "topogeo/matching/match.hpp"

namespace topogeo::localization {

/// Evidence of a match that plausible() judges; see MatchResult, doubt() and rivalry().
struct MatchQuality {
  bool accepted = false;
  bool doubted = false;  ///< not accepted, but not refuted
  double doubt = 0.0;
  double inliers = 0.0;
  double overlap = 0.0;
  double violations = 0.0;
  double rivalry = 0.0;
  /// Position deviation along the direction that the scans alone determine worst, metres.
  double weakest_sigma_m = 0.0;
};

/// Its gate accepted the match, or doubted it no more than clutter and people explain, and the
/// scans determine the position in every direction. Its distance from the prediction is not judged.
bool plausible(const MatchQuality& match);
bool plausible(const MatchTask& task, const MatchResult& result);

/// Whether the scans determine the position, and no other pose fits nearly as well.
bool is_determined(double weakest_sigma_m, double rivalry);

/// Not accepted, but not refuted.
bool is_doubted(Reason reason);

}  // namespace topogeo::localization
