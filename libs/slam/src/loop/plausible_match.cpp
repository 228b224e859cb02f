#include "topogeo/slam/loop/plausible_match.hpp"

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::localization {

bool is_doubted(Reason reason) {
  return reason == Reason::kDoubtful || reason == Reason::kSecondSolution;
}

bool is_determined(double weakest_sigma_m, double rivalry) {
  return !(weakest_sigma_m > PlausibleMatch::kLeastKnown_m ||
           rivalry > PlausibleMatch::kMostRivalry);
}

bool plausible(const MatchQuality& match) {
  if (!is_determined(match.weakest_sigma_m, match.rivalry)) return false;
  return match.accepted || (match.doubted && match.doubt <= PlausibleMatch::kMostDoubt &&
                            match.inliers >= PlausibleMatch::kLeastInliers &&
                            match.overlap >= PlausibleMatch::kLeastOverlap &&
                            match.violations <= PlausibleMatch::kMostViolations);
}

bool plausible(const MatchTask& task, const MatchResult& result) {
  return plausible(MatchQuality{.accepted = result.verdict == Verdict::kAccepted,
                                .doubted = is_doubted(result.reason),
                                .doubt = doubt(result),
                                .inliers = result.inliers,
                                .overlap = result.overlap,
                                .violations = result.violations,
                                .rivalry = rivalry(task, result),
                                .weakest_sigma_m = weakest_sigma_m(data_covariance(result))});
}

}  // namespace topogeo::localization
