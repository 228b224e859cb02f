// Settings of a match of two local maps.
#pragma once

#include <cstdint>

namespace topogeo::localization {

/// How an individual is scored (spec A5).
enum class FitnessForm : std::uint8_t {
  kPrinted = 0,      ///< the equations as the source prints them, for comparison
  kTopological = 1,  ///< equivalent nodes and branches, clearance, orientation, coverage
  kCombined =
      2,  ///< topological and scan points against a distance field, times the odometry prior
};

/// Parameters of the genetic algorithm (spec A4).
struct GeneticParameters {
  std::uint32_t individuals = 50;
  std::uint32_t generations = 30;
  double crossover_rate = 1.0;           ///< probability that two parents exchange genes, 0 to 1
  double mutation_rate = 0.05;           ///< probability per bit, 0.01 to 0.2
  std::uint32_t elite = 2;               ///< best individuals that live on unchanged, at least 1
  std::uint32_t branch_hypotheses = 10;  ///< of the initial individuals, at most: poses that lay a
                                         ///< branch or node on an equivalent one
  double resolution_m = 0.15;            ///< of the x and y genes
  double resolution_rad = 0.034906585;   ///< of the heading gene, 2 degrees
  friend bool operator==(const GeneticParameters&, const GeneticParameters&) = default;
};

/// When the result of a match is believed (see match_gate.hpp).
struct GateConfig {
  double smallest_overlap = 0.20;  ///< share of the query's points in the reference's view
  double smallest_inliers = 0.50;  ///< of those, share on a surface
  double largest_doubt = 2.2;      ///< see doubt()
  double doubt_per_search_m =
      0.25;  ///< less is allowed for a wider search, where look-alikes are likelier
  double largest_mahalanobis2 = 25.0;  ///< between the result and the prediction (3 d.o.f.)
  double largest_ambiguity = 0.95;     ///< see rivalry()
  friend bool operator==(const GateConfig&, const GateConfig&) = default;
};

}  // namespace topogeo::localization
