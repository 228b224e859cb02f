// Genetic search for the pose with the largest fitness (spec A4, thesis 6.2.2-6.2.4).
//
// Binary chromosomes of three genes (x, y, theta), whose length follows from the size of the search
// space so that the precision stays what was asked for. Roulette selection, elitism, one-point
// crossover in each gene, bit-flip mutation. Everything random comes from the task's seed.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/localization/fitness.hpp"
#include "topogeo/localization/match.hpp"

namespace topogeo::localization {

/// Bits per gene (6.25-6.28): enough for the finest of the three intervals, 1 to 24.
std::uint32_t gene_bits(const MatchTask& task);

/// Whether a pose lies in the space that the task says, but for rounding.
bool in_search_space(const MatchTask& task, const geometry::Pose2& T_reference_query);

/// Two poses are one solution when they are nearer than 1.5 times the resolution in position and
/// heading.
bool same_solution(const MatchTask& task, const geometry::Pose2& a, const geometry::Pose2& b);

struct SearchOutcome {
  std::vector<MatchSolution>
      solutions;  ///< the task's `solutions_wanted` best distinct ones, best first
  std::uint32_t evaluations = 0;
};

SearchOutcome genetic_search(const MatchTask& task, const Fitness& fitness);

}  // namespace topogeo::localization
