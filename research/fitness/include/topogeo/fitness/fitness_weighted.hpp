// The topological fitness made good enough for mapping (own; docs/algorithms.md, "Fitness"): nodes
// and branches are weighted by their repeatability, and the odometry prior decides between
// look-alikes.
//
// If branches are the evidence of a match (MatchEvidence::kBranches), the walls that they imply
// count as well, like scan points in the combined form: the walls of an unconfirmed branch are
// right even if the branch is not.
//
// Kernels are half as wide as those of the topological form: a branch is found again within
// centimetres, so a pose 0.3 m aside is not half right.
#pragma once

#include <vector>

#include "topogeo/matching/fitness_forms.hpp"

#include "fitness_combined.hpp"

namespace topogeo::localization {

class WeightedFitness : public AddedFitness {
 public:
  /// bind() before use.
  WeightedFitness() = default;
  WeightedFitness(const Reference& reference, const MatchFeatures& query, const MatchTask& task) {
    bind(reference, query, task);
  }

  /// The maps must outlive their use.
  void bind(const Reference& reference, const MatchFeatures& query, const MatchTask& task) override;

  [[nodiscard]] double at(const geometry::Pose2& T_reference_query,
                          const geometry::SinCos& heading) const override;

  [[nodiscard]] double of_maps(const geometry::Pose2& T_reference_query,
                               const geometry::SinCos& heading) const override;

 private:
  [[nodiscard]] double of_elements(const geometry::Pose2& T, const geometry::SinCos& r) const;
  [[nodiscard]] double of_branches(const geometry::Pose2& T, const geometry::SinCos& r) const;
  [[nodiscard]] double of_nodes(const geometry::Pose2& T, const geometry::SinCos& r) const;

  const Reference* reference_ = nullptr;
  const MatchFeatures* query_ = nullptr;
  OdometryPrior prior_;
  ScanFitness walls_;
  bool with_walls_ = false;
  double per_weight_ = 0.0;
};

}  // namespace topogeo::localization
