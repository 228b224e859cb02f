#include "topogeo/slam/candidate_choice.hpp"

#include <algorithm>

namespace topogeo::localization {

namespace {

// Share of a scan that a match needs at least.
constexpr double kLeastCommon = 0.15;

std::vector<MatchCandidate> by_overlap(std::vector<MatchCandidate> candidates) {
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const MatchCandidate& a, const MatchCandidate& b) { return a.overlap > b.overlap; });
  return candidates;
}

}  // namespace

void CandidateChoice::consider(std::uint32_t id, const RangeProfile& viewer,
                               std::span<const SurfacePoint> outline,
                               const UncertainPose& T_viewer_outline) {
  const double overlap = expected_overlap(viewer, outline, T_viewer_outline, least_overlap_);
  if (overlap >= least_overlap_) found_.push_back({id, overlap});
}

void CandidateChoice::consider_common(std::uint32_t id, const RangeProfile& viewer,
                                      std::span<const SurfacePoint> outline,
                                      const UncertainPose& T_viewer_outline) {
  if (expected_overlap(viewer, outline, T_viewer_outline, least_overlap_) < least_overlap_) return;
  const double common = expected_common(viewer, outline, T_viewer_outline);
  if (common >= kLeastCommon) found_.push_back({id, common});
}

std::vector<MatchCandidate> CandidateChoice::best(std::size_t count) const {
  std::vector<MatchCandidate> chosen = by_overlap(found_);
  if (chosen.size() > count) chosen.resize(count);
  return chosen;
}

std::vector<MatchCandidate> CandidateChoice::best_apart(std::size_t count) const {
  std::vector<MatchCandidate> chosen;
  for (const MatchCandidate& candidate : by_overlap(found_)) {
    if (chosen.size() == count) break;
    const bool neighbour =
        std::any_of(chosen.begin(), chosen.end(), [&](const MatchCandidate& other) {
          return other.id + 1 == candidate.id || candidate.id + 1 == other.id;
        });
    if (!neighbour) chosen.push_back(candidate);
  }
  return chosen;
}

}  // namespace topogeo::localization
