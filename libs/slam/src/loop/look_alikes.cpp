#include "loop/look_alikes.hpp"

#include <algorithm>

#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::localization {

void refuse_look_alikes(std::vector<StopMatch>& matches, const OdometrySteps& steps) {
  const auto found_far = [](const StopMatch& match) { return match.widened && match.accepted(); };
  if (std::any_of(matches.begin(), matches.end(), [&](const StopMatch& match) {
        return found_far(match) && steps.allow(match.edge, LookAlikeLimits::kAllowed2);
      })) {
    return;
  }
  for (StopMatch& match : matches) {
    if (!found_far(match)) continue;
    match.verdict = match.evidence.verdict = Verdict::kRejected;
    match.reason = match.evidence.reason = Reason::kNothingInCommon;
  }
}

}  // namespace topogeo::localization
