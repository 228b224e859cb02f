// Distinct solutions of the backward corrections of a drive (Thesis, 7.3.1.2 and 8.3; docs/
// algorithms.md, "Backward correction"). Each backward correction starts from the poses of the
// forward correction alone, as in figures 8.15 to 8.22, and adds solutions; the earlier ones follow
// the robot by its forward steps. The map is that of the solution with the best overlap of the
// local maps at its poses (8.2): the sum of the fitness of all pairs of maps that only a closed
// cycle brings together.
//
// The pairs are rated by the topological form weighted by repeatability (WeightedFitness), whatever
// form searched, because the printed one rewards pairs that have little in common.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "topogeo/fitness/fitness_weighted.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/thesis/thesis_config.hpp"
#include "topogeo/thesis/thesis_map.hpp"

namespace topogeo::localization {

/// Poses of all stops that close a cycle.
struct CycleSolution {
  std::vector<geometry::Pose2> T_map_stop;
  std::uint32_t earlier = 0;  ///< the map seen again whose match placed the stop `later`
  std::uint32_t later = 0;
  double agreement = 0.0;  ///< summed fitness of the pairs of maps that the cycle brings together
};

class KeptSolutions {
 public:
  /// Reads from `config`: thesis.kept_solutions, recent_way_m, evidence, and the resolution of the
  /// genetic search; solutions closer than that are one.
  explicit KeptSolutions(const ThesisSlamConfig& config);

  /// Takes the last stop of the map, placed by the forward correction; each kept solution gets the
  /// same step.
  void add_stop(const ThesisMap& map);
  /// Keeps the best of the kept solutions and of `found`.
  void offer(const ThesisMap& map, std::vector<CycleSolution> found);
  /// Moves the stops in the known zone together, at a finer resolution (7.3.1.2.2), to where they
  /// agree best with the earlier maps whose own pose is known to the resolution of the search.
  void refine(const ThesisMap& map);

  /// Best first.
  [[nodiscard]] const std::vector<CycleSolution>& all() const { return kept_; }
  /// The best one; null while none agrees with the earlier maps nearly as much as one pair of equal
  /// maps.
  [[nodiscard]] const CycleSolution* best() const;

 private:
  struct Pair {
    std::uint32_t earlier = 0;
    std::uint32_t later = 0;
  };

  double fitness(const ThesisMap& map, const CycleSolution& solution, Pair pair);
  double agreement_of_stop(const ThesisMap& map, const CycleSolution& solution,
                           std::uint32_t later);
  void rank();
  void refine_one(const ThesisMap& map, CycleSolution& solution,
                  const std::vector<UncertainPose>& T_first_stop);

  ThesisSlamConfig config_;
  std::vector<std::shared_ptr<const MatchFeatures>> features_;
  std::vector<Reference> references_;
  MatchTask task_;
  WeightedFitness fitness_;
  std::vector<CycleSolution> kept_;
};

}  // namespace topogeo::localization
