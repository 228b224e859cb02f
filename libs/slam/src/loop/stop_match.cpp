#include "loop/stop_match.hpp"

#include <algorithm>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/loop/loop_config.hpp"
#include "topogeo/slam/loop/plausible_match.hpp"
#include "topogeo/slam/place_recognition.hpp"

namespace topogeo::localization {

double StopMatch::surprise() const {
  if (predicted.covariance.isZero(0.0)) return 0.0;
  return geometry::squared_mahalanobis(geometry::difference(predicted.T_a_b, edge.T_from_to),
                                       predicted.covariance);
}

bool StopMatch::plausible() const {
  // Further from the prediction no place is looked for either.
  if (!predicted.covariance.isZero(0.0) &&
      geometry::squared_mahalanobis(geometry::difference(predicted.T_a_b, edge.T_from_to),
                                    widened_for_places(predicted.covariance)) >
          geometry::kMahalanobis2Of99Percent) {
    return false;
  }
  if (source == ProposalSource::kWindow) {
    return is_determined(weakest_sigma_m, rivalry) && fitness >= PlausibleMatch::kLeastOfWindow &&
           overlap >= PlausibleMatch::kLeastOverlap;
  }
  return localization::plausible({.accepted = accepted(),
                                  .doubted = uncertain(),
                                  .doubt = doubt,
                                  .inliers = inliers,
                                  .overlap = overlap,
                                  .violations = violations,
                                  .rivalry = rivalry,
                                  .weakest_sigma_m = weakest_sigma_m});
}

LoopEvidence StopMatch::loop_evidence() const {
  LoopEvidence known;
  known.kind = source == ProposalSource::kWindow    ? LoopEvidence::Kind::kWindow
               : accepted()                         ? LoopEvidence::Kind::kPassed
               : uncertain()                        ? LoopEvidence::Kind::kDoubtful
               : reason == Reason::kNothingInCommon ? LoopEvidence::Kind::kNone
                                                    : LoopEvidence::Kind::kRefused;
  known.fitness = fitness;
  known.doubt = doubt;
  known.overlap = overlap;
  known.inliers = inliers;
  known.rivalry = rivalry;
  known.weakest_sigma_m = weakest_sigma_m;
  known.surprise = surprise();
  known.agreement = agreement;
  known.rival_agreement = rival_agreement;
  return known;
}

bool any_accepted(std::span<const StopMatch> matches) {
  return std::any_of(matches.begin(), matches.end(),
                     [](const StopMatch& match) { return match.accepted(); });
}

}  // namespace topogeo::localization
