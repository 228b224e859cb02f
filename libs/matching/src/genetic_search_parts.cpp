#include "genetic_search_parts.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::uint32_t kTabledBits = 10;    // longer headings are computed one by one
constexpr std::uint32_t kLargestTable = 17;  // as a power of two: 2 MB

// 0 to n - 1, n < 2^32: faster than Random::below, and uneven by 2^-32 at most.
std::uint32_t draw(support::Random& random, std::uint32_t n) {
  return static_cast<std::uint32_t>(((random.next_u64() >> 32) * n) >> 32);
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

void GeneCoding::bind(const MatchTask& task) {
  centre_ = task.T_reference_query;
  half_width_ = task.half_width;
  bits_ = gene_bits(task);
  largest_ = (1U << bits_) - 1U;
  per_gene_ = 2.0 / largest_;
  headings_.clear();
  if (bits_ > kTabledBits) return;
  for (std::uint32_t gene = 0; gene <= largest_; ++gene) headings_.push_back(heading(gene));
}

GeneCoding::Heading GeneCoding::heading(std::uint32_t gene) const {
  const double theta_rad = geometry::wrap_angle(centre_.theta_rad + offset(gene, 2));
  return {theta_rad, geometry::sincos(theta_rad)};
}

GeneCoding::Place GeneCoding::decode(const Chromosome& genes) const {
  const Heading turned = headings_.empty() ? heading(genes[2]) : headings_[genes[2]];
  return {{centre_.x_m + offset(genes[0], 0), centre_.y_m + offset(genes[1], 1), turned.theta_rad},
          turned.heading};
}

std::uint32_t GeneCoding::gene(double offset, Eigen::Index k) const {
  const double unit = std::clamp(0.5 * (offset / half_width_[k] + 1.0), 0.0, 1.0);
  return static_cast<std::uint32_t>(std::nearbyint(unit * largest_));
}

Chromosome GeneCoding::encode(const Pose2& T_reference_query) const {
  const Eigen::Vector3d d = geometry::difference(T_reference_query, centre_);
  return {gene(d.x(), 0), gene(d.y(), 1), gene(d.z(), 2)};
}

void FitnessTable::start(std::uint32_t bits, std::uint64_t evaluations) {
  bits_ = bits;
  std::uint32_t size = 6;
  while (size < kLargestTable && (std::uint64_t{1} << size) < evaluations) ++size;
  ++stamp_;
  if (slots_.size() < (std::size_t{1} << size) || stamp_ > kLastStamp) {
    slots_.assign(std::max(slots_.size(), std::size_t{1} << size), Slot{});
    stamp_ = 1;
  }
  shift_ = 64U - size;
}

void Roulette::fill(const std::vector<Individual>& population) {
  const std::size_t size = population.size();
  cumulative_.resize(size);
  first_.resize(size);
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) cumulative_[i] = sum += population[i].fitness;
  const double part = sum / static_cast<double>(size);
  std::uint32_t i = 0;
  for (std::size_t k = 0; k < size; ++k) {
    while (i + 1 < size && cumulative_[i] <= part * static_cast<double>(k)) ++i;
    first_[k] = i;
  }
}

std::size_t Roulette::spin(support::Random& random) const {
  const double turn = random.uniform();
  const double spot = turn * cumulative_.back();
  const auto size = static_cast<double>(cumulative_.size());
  std::size_t i = first_[std::min(static_cast<std::size_t>(turn * size), cumulative_.size() - 1)];
  while (i + 1 < cumulative_.size() && cumulative_[i] <= spot) ++i;
  return i;
}

void cross(Chromosome& a, Chromosome& b, std::uint32_t bits, support::Random& random) {
  if (bits < 2) return;
  const std::uint32_t cut = 1U + draw(random, bits - 1U);
  const std::uint32_t low = (1U << cut) - 1U;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::uint32_t exchanged = (a[k] ^ b[k]) & low;
    a[k] ^= exchanged;
    b[k] ^= exchanged;
  }
}

// Draws the number of flipped bits first, from the binomial distribution, and then the bits: hardly
// any flip, so this takes far fewer random numbers than one per bit.
void Mutation::bind(std::uint32_t bits, double rate) {
  bits_ = bits;
  const std::uint32_t all = 3 * bits;
  double probability = 1.0;
  for (std::uint32_t i = 0; i < all; ++i) probability *= 1.0 - rate;
  at_most_.clear();
  double sum = 0.0;
  for (std::uint32_t k = 0; k < all; ++k) {
    at_most_.push_back(sum += probability);
    probability *= rate / (1.0 - rate) * (all - k) / (k + 1.0);
  }
}

void Mutation::operator()(Chromosome& genes, support::Random& random) const {
  const double spot = random.uniform();
  std::size_t count = 0;
  while (count < at_most_.size() && spot >= at_most_[count]) ++count;
  Chromosome flipped{};
  while (count > 0) {
    const std::uint32_t place = draw(random, 3 * bits_);
    const std::uint32_t bit = 1U << (place % bits_);
    std::uint32_t& gene = flipped[place / bits_];
    if ((gene & bit) != 0) continue;
    gene |= bit;
    --count;
  }
  for (std::size_t k = 0; k < genes.size(); ++k) genes[k] ^= flipped[k];
}

}  // namespace topogeo::localization
