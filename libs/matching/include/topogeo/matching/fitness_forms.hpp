// All forms of the fitness for one pair of maps, reused from match to match to save allocations.
#pragma once

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/fitness.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/support/value_pointer.hpp"

namespace topogeo::localization {

class CombinedFitness;

class FitnessForms {
 public:
  /// bind() before use.
  FitnessForms();
  FitnessForms(const Reference& reference, const MatchFeatures& query, const MatchTask& task);
  FitnessForms(const FitnessForms& other);
  FitnessForms(FitnessForms&& other) noexcept;
  FitnessForms& operator=(const FitnessForms& other);
  FitnessForms& operator=(FitnessForms&& other) noexcept;
  ~FitnessForms();

  /// The maps must outlive their use. Allocates only for a larger map than ever before.
  void bind(const Reference& reference, const MatchFeatures& query, const MatchTask& task);

  /// The form that the task names.
  [[nodiscard]] const Fitness& chosen() const;

  /// Fitness by the maps alone: without the odometry prior that two of the forms have.
  [[nodiscard]] double of_maps(const geometry::Pose2& T_reference_query,
                               const geometry::SinCos& heading) const;

  /// Factors of the combined form.
  struct Parts {
    double scan = 0.0;
    double topological = 0.0;
    double prior = 0.0;
  };
  [[nodiscard]] Parts parts(const geometry::Pose2& T_reference_query) const;

  [[nodiscard]] const CombinedFitness& combined() const;

 private:
  struct Forms;
  support::ValuePointer<Forms> forms_;
};

}  // namespace topogeo::localization
