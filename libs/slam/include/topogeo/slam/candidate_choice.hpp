// Chooses the maps to match a new one with: those that should have most of their view in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/matching/expected_overlap.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

struct MatchCandidate {
  std::uint32_t id = 0;
  double overlap = 0.0;  ///< expected_overlap(), or more for a map taken in any case
};

class CandidateChoice {
 public:
  /// `least_overlap`: below it a map is no candidate.
  explicit CandidateChoice(double least_overlap) : least_overlap_(least_overlap) {}

  /// Considers a map by its expected overlap; see expected_overlap().
  void consider(std::uint32_t id, const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                const UncertainPose& T_viewer_outline);
  /// Like consider(), but ordered by expected_common(), which must reach a minimum.
  void consider_common(std::uint32_t id, const RangeProfile& viewer,
                       std::span<const SurfacePoint> outline,
                       const UncertainPose& T_viewer_outline);
  /// Takes a map ahead of all considered ones.
  void take(std::uint32_t id) { found_.push_back({id, kTaken}); }

  /// At most `count` candidates of largest overlap; equal ones in the order of consideration.
  [[nodiscard]] std::vector<MatchCandidate> best(std::size_t count) const;
  /// Like best(), but without neighbours (by id) of a better candidate, because two successive
  /// stops see nearly the same of another drive.
  [[nodiscard]] std::vector<MatchCandidate> best_apart(std::size_t count) const;

 private:
  static constexpr double kTaken = 2.0;  // above every overlap

  double least_overlap_;
  std::vector<MatchCandidate> found_;
};

}  // namespace topogeo::localization
