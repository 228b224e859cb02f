// The corrected fitness (docs/algorithms.md, "Fitness"): equivalent nodes and branches, clearance,
// orientation and coverage of the query's map.
//
// Each node and each sample of a branch of the query map scores a soft kernel of its distance to
// the nearest equivalent element of the reference map, times kernels of the difference in clearance
// and in direction (1 when aligned, undirected). An element without a partner scores 0: the mean
// over *all* elements therefore counts coverage, which the printed form does not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/matching/fitness_forms.hpp"

#include "fitness_points.hpp"

namespace topogeo::localization {

class TopologicalFitness : public Fitness {
 public:
  /// bind() before use.
  TopologicalFitness() = default;
  TopologicalFitness(const Reference& reference, const MatchFeatures& query) {
    bind(reference, query);
  }

  /// Both must outlive their use. Allocates only for a larger map than ever before.
  void bind(const Reference& reference, const MatchFeatures& query);

  /// The query has neither nodes nor branches: the fitness is 0 everywhere.
  [[nodiscard]] bool empty() const { return per_weight_ == 0.0; }

  [[nodiscard]] double at(const geometry::Pose2& T_reference_query,
                          const geometry::SinCos& heading) const override;

 private:
  [[nodiscard]] double branch_scores(std::size_t first, std::size_t count,
                                     const FloatPose& T) const;
  [[nodiscard]] double node_scores(const FloatPose& T) const;

  const Reference* reference_ = nullptr;
  const MatchFeatures* query_ = nullptr;
  LaneArray x_m_;  // of the query's branch samples
  LaneArray y_m_;
  LaneArray direction_x_;
  LaneArray direction_y_;
  LaneArray clearance_m_;
  double per_weight_ = 0.0;
};

}  // namespace topogeo::localization
