#include "genetic_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace topogeo::localization {

using geometry::Pose2;

bool in_search_space(const MatchTask& task, const Pose2& T_reference_query) {
  constexpr double kRounding = 1e-9;
  const Eigen::Vector3d d = geometry::difference(T_reference_query, task.T_reference_query);
  return ((d.cwiseAbs() - task.half_width).array() <= kRounding).all();
}

bool same_solution(const MatchTask& task, const Pose2& a, const Pose2& b) {
  const double apart_m = 1.5 * task.genetic.resolution_m;
  const double apart_rad = 1.5 * task.genetic.resolution_rad;
  const double turn_rad = std::fabs(a.theta_rad - b.theta_rad);
  return (a.position_m() - b.position_m()).squaredNorm() < apart_m * apart_m &&
         std::min(turn_rad, 2.0 * std::numbers::pi - turn_rad) < apart_rad;
}

void GeneticSearch::first_population(const MatchTask& task, std::span<const Pose2> hypotheses,
                                     support::Random& random) {
  const std::size_t size = task.genetic.individuals;
  population_.clear();
  population_.push_back({coding_.encode(task.T_reference_query), 0.0});
  for (const std::span<const Pose2> poses :
       {std::span<const Pose2>(task.initial_individuals), hypotheses}) {
    for (const Pose2& pose : poses) {
      if (population_.size() < size) population_.push_back({coding_.encode(pose), 0.0});
    }
  }
  while (population_.size() < size) {
    Individual individual;
    for (std::uint32_t& gene : individual.genes) {
      gene = static_cast<std::uint32_t>(random.below(coding_.largest() + 1ULL));
    }
    population_.push_back(individual);
  }
}

void GeneticSearch::evaluate(const Fitness& fitness, Individual& individual) {
  individual.fitness = table_(individual.genes, [&] {
    const GeneCoding::Place place = coding_.decode(individual.genes);
    met_.push_back({place.T_reference_query, fitness.at(place.T_reference_query, place.heading)});
    return met_.back().fitness;
  });
}

// Copies the best individuals, best first, to the start of the next generation.
void GeneticSearch::keep_elite(std::size_t count) {
  std::iota(order_.begin(), order_.end(), 0U);
  const auto end = order_.begin() + static_cast<std::ptrdiff_t>(count);
  std::partial_sort(order_.begin(), end, order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double of_a = population_[a].fitness;
    const double of_b = population_[b].fitness;
    return of_a > of_b || (of_a == of_b && a < b);
  });
  for (std::size_t i = 0; i < count; ++i) next_[i] = population_[order_[i]];
}

std::uint32_t GeneticSearch::run(const MatchTask& task, const Fitness& fitness,
                                 std::span<const Pose2> hypotheses) {
  const GeneticParameters& genetic = task.genetic;
  const std::uint64_t most = std::uint64_t{genetic.individuals} * genetic.generations;
  coding_.bind(task);
  table_.start(coding_.bits(), most);
  mutation_.bind(coding_.bits(), genetic.mutation_rate);
  met_.clear();
  met_.reserve(most);
  next_.resize(genetic.individuals);
  order_.resize(genetic.individuals);
  support::Random random(task.seed);

  first_population(task, hypotheses, random);
  for (Individual& individual : population_) evaluate(fitness, individual);
  std::uint32_t evaluations = genetic.individuals;
  for (std::uint32_t generation = 1; generation < genetic.generations; ++generation) {
    roulette_.fill(population_);
    if (roulette_.empty()) break;  // nothing in common anywhere, so there is no basis for selection
    keep_elite(genetic.elite);
    for (std::size_t i = genetic.elite; i < next_.size(); i += 2) {
      Chromosome a = population_[roulette_.spin(random)].genes;
      Chromosome b = population_[roulette_.spin(random)].genes;
      if (random.uniform() < genetic.crossover_rate) cross(a, b, coding_.bits(), random);
      for (const auto& [child, place] : {std::pair{&a, i}, std::pair{&b, i + 1}}) {
        if (place == next_.size()) break;
        mutation_(*child, random);
        next_[place].genes = *child;
        evaluate(fitness, next_[place]);
        ++evaluations;
      }
    }
    std::swap(population_, next_);
  }
  return evaluations;
}

}  // namespace topogeo::localization
