#include "topogeo/localization/genetic_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

using Chromosome = std::array<std::uint32_t, 3>;

struct Individual {
  Chromosome genes{};
  double fitness = 0.0;
};

// Between genes and poses: a gene of all zeros is the lower end of its interval, all ones the
// upper.
class Coding {
 public:
  explicit Coding(const MatchTask& task)
      : centre_(task.T_reference_query),
        half_width_(task.half_width),
        bits_(gene_bits(task)),
        largest_((1U << bits_) - 1U) {}

  [[nodiscard]] Pose2 decode(const Chromosome& genes) const {
    return {centre_.x_m + offset(genes, 0), centre_.y_m + offset(genes, 1),
            geometry::wrap_angle(centre_.theta_rad + offset(genes, 2))};
  }
  [[nodiscard]] Chromosome encode(const Pose2& pose) const {
    return {gene(pose.x_m - centre_.x_m, 0), gene(pose.y_m - centre_.y_m, 1),
            gene(geometry::wrap_angle(pose.theta_rad - centre_.theta_rad), 2)};
  }
  [[nodiscard]] std::uint32_t bits() const { return bits_; }
  [[nodiscard]] std::uint32_t largest() const { return largest_; }

 private:
  [[nodiscard]] double offset(const Chromosome& genes, std::size_t k) const {
    return half_width_[static_cast<Eigen::Index>(k)] * (2.0 * genes[k] / largest_ - 1.0);
  }
  [[nodiscard]] std::uint32_t gene(double offset, std::size_t k) const {
    const double half = half_width_[static_cast<Eigen::Index>(k)];
    if (half <= 0.0) return 0;
    const double unit = std::clamp(0.5 * (offset / half + 1.0), 0.0, 1.0);
    return static_cast<std::uint32_t>(std::nearbyint(unit * largest_));
  }

  Pose2 centre_;
  Eigen::Vector3d half_width_;
  std::uint32_t bits_;
  std::uint32_t largest_;
};

// Fitness of the chromosomes met so far. A population that converges breeds the same ones again and
// again, and their fitness is what a search spends its time on.
class KnownFitness {
 public:
  explicit KnownFitness(const MatchTask& task) : bits_(gene_bits(task)) {
    const std::uint64_t chromosomes = std::uint64_t{1} << std::min(3U * bits_, kLargestBits);
    const std::uint64_t individuals =
        std::uint64_t{task.genetic.individuals} * std::uint64_t{task.genetic.generations};
    std::uint64_t slots = 64;
    while (slots < std::min(chromosomes, 2 * individuals)) slots *= 2;
    slots_.assign(slots, Slot{});
  }

  /// The fitness of the chromosome, from `evaluate` when it was not met lately.
  template <typename Evaluate>
  double operator()(const Chromosome& genes, const Evaluate& evaluate) {
    if (3U * bits_ > 63U) return evaluate();
    const std::uint64_t key = 1U + (std::uint64_t{genes[0]} | std::uint64_t{genes[1]} << bits_ |
                                    std::uint64_t{genes[2]} << (2U * bits_));
    // Each chromosome has one slot, in which a later one of the same slot replaces it.
    Slot& slot = slots_[support::splitmix64(key) & (slots_.size() - 1)];
    if (slot.key != key) slot = {key, evaluate()};
    return slot.fitness;
  }

 private:
  static constexpr std::uint32_t kLargestBits = 16;  // of the number of slots: 1 MB
  struct Slot {
    std::uint64_t key = 0;  // 0: empty
    double fitness = 0.0;
  };
  std::uint32_t bits_;
  std::vector<Slot> slots_;
};

// The best distinct solutions seen so far.
class Archive {
 public:
  explicit Archive(const MatchTask& task) : task_(task), wanted_(task.solutions_wanted) {}

  void offer(const Pose2& pose, double fitness) {
    if (solutions_.size() >= wanted_ && fitness <= solutions_.back().fitness) return;
    for (std::size_t i = 0; i < solutions_.size(); ++i) {
      if (!same_solution(task_, solutions_[i].T_reference_query, pose)) continue;
      if (fitness <= solutions_[i].fitness) return;
      solutions_.erase(solutions_.begin() + static_cast<std::ptrdiff_t>(i));
      --i;
    }
    const auto place = std::find_if(solutions_.begin(), solutions_.end(),
                                    [&](const MatchSolution& s) { return fitness > s.fitness; });
    solutions_.insert(place, {pose, fitness});
    if (solutions_.size() > wanted_) solutions_.pop_back();
  }
  [[nodiscard]] const std::vector<MatchSolution>& solutions() const { return solutions_; }

 private:
  const MatchTask& task_;
  std::uint32_t wanted_;
  std::vector<MatchSolution> solutions_;
};

// Index drawn with probability proportional to fitness.
std::size_t spin_roulette(const std::vector<double>& cumulative, support::Random& random) {
  const double spot = random.uniform() * cumulative.back();
  const auto found = std::upper_bound(cumulative.begin(), cumulative.end(), spot);
  return std::min(static_cast<std::size_t>(found - cumulative.begin()), cumulative.size() - 1);
}

void cross(Chromosome& a, Chromosome& b, std::uint32_t bits, support::Random& random) {
  if (bits < 2) return;
  const auto cut = 1U + static_cast<std::uint32_t>(random.below(bits - 1));
  const std::uint32_t low = (1U << cut) - 1U;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::uint32_t exchanged = (a[k] ^ b[k]) & low;
    a[k] ^= exchanged;
    b[k] ^= exchanged;
  }
}

void mutate(Chromosome& genes, std::uint32_t bits, double rate, support::Random& random) {
  for (std::uint32_t& gene : genes) {
    for (std::uint32_t bit = 0; bit < bits; ++bit) {
      if (random.uniform() < rate) gene ^= 1U << bit;
    }
  }
}

std::vector<Individual> first_population(const MatchTask& task, const Coding& coding,
                                         support::Random& random) {
  const std::size_t size = std::max<std::uint32_t>(4, task.genetic.individuals);
  std::vector<Individual> population;
  population.reserve(size);
  population.push_back({coding.encode(task.T_reference_query), 0.0});
  for (const Pose2& pose : task.initial_individuals) {
    if (population.size() < size) population.push_back({coding.encode(pose), 0.0});
  }
  while (population.size() < size) {
    Individual individual;
    for (std::uint32_t& gene : individual.genes) {
      gene = static_cast<std::uint32_t>(random.below(coding.largest() + 1ULL));
    }
    population.push_back(individual);
  }
  return population;
}

bool fitter(const Individual& a, const Individual& b) {
  return a.fitness > b.fitness;
}

}  // namespace

std::uint32_t gene_bits(const MatchTask& task) {
  const double steps = std::max({2.0 * task.half_width.x() / task.genetic.resolution_m,
                                 2.0 * task.half_width.y() / task.genetic.resolution_m,
                                 2.0 * task.half_width.z() / task.genetic.resolution_rad});
  std::uint32_t bits = 1;
  while (bits < 24 && static_cast<double>((1U << bits) - 1U) < steps) ++bits;
  return bits;
}

bool in_search_space(const MatchTask& task, const Pose2& T_reference_query) {
  constexpr double kRounding = 1e-9;
  const Eigen::Vector3d d = geometry::difference(T_reference_query, task.T_reference_query);
  return ((d.cwiseAbs() - task.half_width).array() <= kRounding).all();
}

bool same_solution(const MatchTask& task, const Pose2& a, const Pose2& b) {
  const double apart_m = 1.5 * task.genetic.resolution_m;
  const double apart_rad = 1.5 * task.genetic.resolution_rad;
  return (a.position_m() - b.position_m()).squaredNorm() < apart_m * apart_m &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) < apart_rad;
}

SearchOutcome genetic_search(const MatchTask& task, const Fitness& fitness) {
  const Coding coding(task);
  support::Random random(task.seed);
  Archive archive(task);
  KnownFitness known(task);
  SearchOutcome outcome;
  const auto evaluate = [&](Individual& individual) {
    const Pose2 pose = coding.decode(individual.genes);
    individual.fitness = known(individual.genes, [&] { return fitness(pose); });
    archive.offer(pose, individual.fitness);
    ++outcome.evaluations;
  };

  std::vector<Individual> population = first_population(task, coding, random);
  for (Individual& individual : population) evaluate(individual);
  std::stable_sort(population.begin(), population.end(), fitter);

  constexpr std::size_t kElite = 2;
  std::vector<Individual> next(population.size());
  std::vector<double> cumulative(population.size());
  for (std::uint32_t generation = 1; generation < task.genetic.generations; ++generation) {
    double sum = 0.0;
    for (std::size_t i = 0; i < population.size(); ++i) {
      cumulative[i] = sum += population[i].fitness;
    }
    if (sum <= 0.0) break;  // nothing in common anywhere: there is nothing to select by
    for (std::size_t i = 0; i < kElite; ++i) next[i] = population[i];
    for (std::size_t i = kElite; i < next.size(); i += 2) {
      Chromosome a = population[spin_roulette(cumulative, random)].genes;
      Chromosome b = population[spin_roulette(cumulative, random)].genes;
      cross(a, b, coding.bits(), random);
      for (Chromosome* child : {&a, &b}) {
        const std::size_t place = i + (child == &b ? 1 : 0);
        if (place >= next.size()) break;
        mutate(*child, coding.bits(), task.genetic.mutation_rate, random);
        next[place].genes = *child;
        evaluate(next[place]);
      }
    }
    std::swap(population, next);
    std::stable_sort(population.begin(), population.end(), fitter);
  }
  outcome.solutions = archive.solutions();
  return outcome;
}

}  // namespace topogeo::localization
