// The fitness as the thesis prints it (Thesis, eq. 6.30-6.37), for comparison with the one in use.
//
// 1 / (mean distance of the equivalent nodes and branches + 1). The distance of two branches is
// taken between the ends of one and the points of the other (eq. 6.34), combined by eq. 6.35 and
// multiplied by a factor of their orientation (eq. 6.36). A branch may be equivalent to several:
// the mean over them counts.
//
// Its errors (docs/algorithms.md, "Fitness", errata) make it unfit for a robot:
// - Eq. 6.35 divides by 2 outside the root; a quadratic mean divides by 2 inside.
// - Eq. 6.36 is 0 for parallel branches, so one beside another scores as if it lay on it. It
//   divides by 0 if both lie along x; here 0 / 0 is 0. It is near 1 for two nearly parallel
//   branches on both sides of the x axis, whose angles are near 0 and near pi.
// - The mean is over equivalent elements only, so a pose with few equivalents is rewarded.
//
// The thesis leaves these choices open: equivalent nodes are nearer than 0.6 m and differ by no
// more than 0.3 m in clearance, and the nearest one counts; equivalent branches are no further
// apart than 0.6 m by eq. 6.35, differ by no more than 30 degrees in inclination and 0.3 m in mean
// clearance, and project on each other at two ends. The angle of a branch is that of the chord
// between its ends, in [0, pi).
#pragma once

#include <vector>

#include "topogeo/matching/fitness_forms.hpp"

namespace topogeo::localization {

class PrintedFitness : public AddedFitness {
 public:
  /// bind() before use.
  PrintedFitness() = default;
  PrintedFitness(const Reference& reference, const MatchFeatures& query) { bind(reference, query); }

  /// Both must outlive their use. Allocates only for more branches than ever before.
  void bind(const Reference& reference, const MatchFeatures& query);
  void bind(const Reference& reference, const MatchFeatures& query,
            const MatchTask& /*task*/) override {
    bind(reference, query);
  }

  [[nodiscard]] double at(const geometry::Pose2& T_reference_query,
                          const geometry::SinCos& heading) const override;

  /// The same as at(): the printed form has no odometry in it.
  [[nodiscard]] double of_maps(const geometry::Pose2& T_reference_query,
                               const geometry::SinCos& heading) const override {
    return at(T_reference_query, heading);
  }

 private:
  struct Pose;  // the pose and its inverse, with its sine and cosine
  struct Mean;

  void add_nodes(const Pose& pose, Mean& mean) const;
  void add_branches(const Pose& pose, Mean& mean) const;
  [[nodiscard]] double branch_distance_m(const Pose& pose, const BranchCurve& query,
                                         const BranchCurve& reference) const;

  const MatchFeatures* reference_ = nullptr;
  const MatchFeatures* query_ = nullptr;
  std::vector<double> reference_angles_rad_;  // of the chords, each in its own map's frame
  std::vector<double> query_angles_rad_;
};

}  // namespace topogeo::localization
