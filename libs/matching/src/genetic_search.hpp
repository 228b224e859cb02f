// Genetic search for the pose with the largest fitness (Thesis, 6.2.2-6.2.4; docs/algorithms.md,
// "Genetic search").
//
// Binary chromosomes of three genes (x, y, theta), whose length follows from the size of the search
// space so that the precision stays as requested. Roulette selection, elitism, one-point
// crossover in each gene, bit-flip mutation. Everything random comes from the task's seed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/match.hpp"

#include "genetic_search_parts.hpp"

namespace topogeo::localization {

/// Whether a pose lies in the search space of the task, within rounding.
bool in_search_space(const MatchTask& task, const geometry::Pose2& T_reference_query);

/// Two poses are one solution when they are nearer than 1.5 times the resolution in position and
/// heading. Headings in [-pi, pi].
bool same_solution(const MatchTask& task, const geometry::Pose2& a, const geometry::Pose2& b);

class GeneticSearch {
 public:
  /// Runs the search. The first population is the predicted pose, the task's initial individuals,
  /// the `hypotheses` and, as far as there is room, poses spread over the space. Ends early if no
  /// individual of a generation has a fitness above 0. Does not allocate after a search of the same
  /// size. Returns the number of scored individuals.
  std::uint32_t run(const MatchTask& task, const Fitness& fitness,
                    std::span<const geometry::Pose2> hypotheses);

  /// The best pose of the last run, then the best one distinct from it, and so on, at most `count`.
  /// `same(a, b)` is true for poses that are not distinct.
  template <typename Same>
  void best_distinct(std::size_t count, const Same& same, std::vector<MatchSolution>& out);

 private:
  void first_population(const MatchTask& task, std::span<const geometry::Pose2> hypotheses,
                        support::Random& random);
  void evaluate(const Fitness& fitness, Individual& individual);
  void keep_elite(std::size_t count);

  GeneCoding coding_;
  FitnessTable table_;
  Roulette roulette_;
  Mutation mutation_;
  std::vector<Individual> population_;
  std::vector<Individual> next_;
  std::vector<std::uint32_t> order_;
  std::vector<MatchSolution> met_;  // all scored poses, each once or twice
  std::vector<std::uint8_t> taken_;
};

template <typename Same>
void GeneticSearch::best_distinct(std::size_t count, const Same& same,
                                  std::vector<MatchSolution>& out) {
  taken_.reserve(met_.capacity());
  taken_.assign(met_.size(), 0);
  out.clear();
  while (out.size() < count) {
    std::size_t best = met_.size();
    for (std::size_t i = 0; i < met_.size(); ++i) {
      if (taken_[i] == 0 && (best == met_.size() || met_[i].fitness > met_[best].fitness)) best = i;
    }
    if (best == met_.size()) return;
    out.push_back(met_[best]);
    if (out.size() == count) return;
    for (std::size_t i = 0; i < met_.size(); ++i) {
      if (taken_[i] == 0 && same(met_[best].T_reference_query, met_[i].T_reference_query)) {
        taken_[i] = 1;
      }
    }
    taken_[best] = 1;
  }
}

}  // namespace topogeo::localization
