// Settings of a match of two local maps.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

/// How an individual is scored (docs/algorithms.md, "Fitness").
enum class FitnessForm : std::uint8_t {
  kPrinted = 0,      ///< the equations as printed in the thesis, for comparison
  kTopological = 1,  ///< equivalent nodes and branches, clearance, orientation, coverage
  kCombined =
      2,  ///< topological and scan points against a distance field, times the odometry prior
  kTopologicalWeighted = 3,  ///< nodes and branches by repeatability, times the odometry prior
};

/// Evidence that refines the solutions of a search and decides whether the match is accepted.
enum class MatchEvidence : std::uint8_t {
  kScan = 0,      ///< least squares of scan points, and the gate
  kBranches = 1,  ///< the same with walls implied by branches; no scan point counts
  kFitness = 2,   ///< only the fitness, as in the thesis: any above 0 is accepted
};

/// Parameters of the genetic algorithm (docs/algorithms.md, "Genetic search").
struct GeneticParameters {
  std::uint32_t individuals = 50;
  std::uint32_t generations = 30;
  double crossover_rate = 1.0;
  double mutation_rate = 0.05;
  std::uint32_t elite = 2;
  std::uint32_t branch_hypotheses = 10;
  double resolution_m = 0.15;
  double resolution_rad = 0.034906585;         ///< 2 degrees
  double finer_resolution_m = 0.0;             ///< of a second search around each solution; 0: none
  double finer_resolution_rad = 0.0087266463;  ///< 0.5 degrees
  friend bool operator==(const GeneticParameters&, const GeneticParameters&) = default;
};

/// Conditions for accepting the result of a match (match_gate.hpp).
struct GateConfig {
  double smallest_overlap = 0.20;
  double smallest_inliers = 0.50;
  double largest_doubt = 2.2;  ///< see doubt()
  double doubt_per_search_m = 0.25;
  double largest_mahalanobis2 = 25.0;  ///< 3 degrees of freedom
  double largest_ambiguity = 0.95;     ///< see rivalry()
  friend bool operator==(const GateConfig&, const GateConfig&) = default;
};

// Declare the genetic search in the section `match`, and the section `gate`.
void describe(GeneticParameters& parameters, support::ConfigSchema& schema);
void describe(GateConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
