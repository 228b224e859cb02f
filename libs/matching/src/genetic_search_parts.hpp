// The parts of the genetic search, each reusable without allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::localization {

/// Genes x, y and theta.
using Chromosome = std::array<std::uint32_t, 3>;

struct Individual {
  Chromosome genes{};
  double fitness = 0.0;
};

/// Bits per gene (6.25-6.28): enough for the finest of the three intervals, 1 to 24.
std::uint32_t gene_bits(const MatchTask& task);

/// Converts between genes and poses: a gene of all zeros is the lower end of its interval, all ones
/// the upper end.
class GeneCoding {
 public:
  void bind(const MatchTask& task);

  [[nodiscard]] std::uint32_t bits() const { return bits_; }
  /// The largest value of a gene.
  [[nodiscard]] std::uint32_t largest() const { return largest_; }

  struct Place {
    geometry::Pose2 T_reference_query;
    geometry::SinCos heading;
  };
  [[nodiscard]] Place decode(const Chromosome& genes) const;

  /// The genes nearest to a pose; for a pose outside the space those of the nearest border.
  [[nodiscard]] Chromosome encode(const geometry::Pose2& T_reference_query) const;

 private:
  struct Heading {
    double theta_rad;
    geometry::SinCos heading;
  };
  [[nodiscard]] double offset(std::uint32_t gene, Eigen::Index k) const {
    return half_width_[k] * (gene * per_gene_ - 1.0);
  }
  [[nodiscard]] Heading heading(std::uint32_t gene) const;
  [[nodiscard]] std::uint32_t gene(double offset, Eigen::Index k) const;

  geometry::Pose2 centre_;
  Eigen::Vector3d half_width_ = Eigen::Vector3d::Zero();
  std::uint32_t bits_ = 1;
  std::uint32_t largest_ = 1;
  double per_gene_ = 1.0;
  std::vector<Heading> headings_;  // of every gene, unless there are too many
};

/// Fitness of the chromosomes met so far. A converging population breeds the same ones again and
/// again, and their fitness takes most of the time of a search.
class FitnessTable {
 public:
  /// Clears the table. `bits` per gene; `evaluations` is about the number of chromosomes to come.
  void start(std::uint32_t bits, std::uint64_t evaluations);

  /// The fitness of the chromosome; calls `evaluate()` unless it was met lately.
  template <typename Evaluate>
  double operator()(const Chromosome& genes, const Evaluate& evaluate) {
    if (3 * bits_ > kKeyBits) return evaluate();
    const std::uint64_t key = std::uint64_t{genes[0]} | std::uint64_t{genes[1]} << bits_ |
                              std::uint64_t{genes[2]} << (2 * bits_) | stamp_ << kKeyBits;
    // Each chromosome has one slot; a later chromosome with the same slot replaces it.
    Slot& slot = slots_[(key * 0x9e3779b97f4a7c15ULL) >> shift_];
    if (slot.key != key) slot = {key, evaluate()};
    return slot.fitness;
  }

 private:
  static constexpr std::uint32_t kKeyBits = 40;
  static constexpr std::uint64_t kLastStamp = (std::uint64_t{1} << (64 - kKeyBits)) - 1;
  struct Slot {
    std::uint64_t key = 0;
    double fitness = 0.0;
  };
  std::uint32_t bits_ = 1;
  std::uint32_t shift_ = 63;
  std::uint64_t stamp_ = 0;  // of this search; slots with another stamp are empty
  std::vector<Slot> slots_;
};

/// Draws individuals with probability proportional to their fitness.
class Roulette {
 public:
  void fill(const std::vector<Individual>& population);

  /// No individual has a fitness above 0.
  [[nodiscard]] bool empty() const { return !(cumulative_.back() > 0.0); }

  /// Index of an individual; the wheel must not be empty.
  std::size_t spin(support::Random& random) const;

 private:
  std::vector<double> cumulative_;
  std::vector<std::uint32_t> first_;  // start of the k-th of as many equal parts of the wheel
};

/// Exchanges the low bits of each gene below a random place (one-point crossover).
void cross(Chromosome& a, Chromosome& b, std::uint32_t bits, support::Random& random);

/// Flips each bit with the same probability.
class Mutation {
 public:
  /// `rate` in [0, 0.5].
  void bind(std::uint32_t bits, double rate);
  void operator()(Chromosome& genes, support::Random& random) const;

 private:
  std::uint32_t bits_ = 1;
  std::vector<double> at_most_;  // probability that at most k bits flip
};

}  // namespace topogeo::localization
