// Chooses the maps that a new one is matched with: those that should see most of each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/localization/matching/expected_overlap.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

struct MatchCandidate {
  std::uint32_t id = 0;
  double overlap = 0.0;  ///< expected_overlap(), or more for one that is taken in any case
};

class CandidateChoice {
 public:
  /// `least_overlap`: of a candidate.
  explicit CandidateChoice(double least_overlap) : least_overlap_(least_overlap) {}

  /// Considers a map by the overlap that is to be expected; see expected_overlap().
  void consider(std::uint32_t id, const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                const UncertainPose& T_viewer_outline);
  /// The same, ordered by expected_common(), of which it wants some.
  void consider_common(std::uint32_t id, const RangeProfile& viewer,
                       std::span<const SurfacePoint> outline,
                       const UncertainPose& T_viewer_outline);
  /// Takes a map before all that are considered.
  void take(std::uint32_t id) { found_.push_back({id, kTaken}); }

  /// The candidates of largest overlap, at most so many; of equal ones the earlier considered.
  [[nodiscard]] std::vector<MatchCandidate> best(std::size_t count) const;
  /// The same without any whose id is next to that of a better one: what two stops in succession
  /// see of another drive is nearly the same.
  [[nodiscard]] std::vector<MatchCandidate> best_apart(std::size_t count) const;

 private:
  static constexpr double kTaken = 2.0;  // above every overlap

  double least_overlap_;
  std::vector<MatchCandidate> found_;
};

}  // namespace topogeo::localization
