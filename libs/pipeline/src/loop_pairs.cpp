#include "loop_pairs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

namespace topogeo::pipeline {
namespace {

// Definition of the pairs that measure the loop error of a trajectory: places nearer than this,
// with at least so much path between them. They are part of the meaning of the error.
constexpr double kNear_m = 1.5;
constexpr double kPathBetween_m = 20.0;
constexpr std::size_t kMostPairs = 2000;     // a sample of longer paths
constexpr std::size_t kPosesLookedAt = 400;  // approximate; longer paths are thinned out

/// Gives std::mt19937 the state of Python's generator after `seed(0)`: init_by_array of the
/// reference implementation of the Mersenne Twister with the key {0}, which no standard seed
/// provides.
struct PythonSeed {
  using result_type = std::uint32_t;

  template <typename Iterator>
  void generate(Iterator begin, Iterator end) const {
    const auto n = static_cast<std::size_t>(end - begin);
    std::vector<std::uint32_t> state(n);
    state[0] = 19650218U;
    const auto mixed = [&](std::size_t i) { return state[i - 1] ^ (state[i - 1] >> 30U); };
    for (std::size_t i = 1; i < n; ++i) {
      state[i] = 1812433253U * mixed(i) + static_cast<std::uint32_t>(i);
    }
    std::size_t i = 1;
    const auto next = [&] {
      if (++i < n) return;
      state[0] = state[n - 1];
      i = 1;
    };
    for (std::size_t k = 0; k < n; ++k, next()) {
      state[i] ^= mixed(i) * 1664525U;  // plus key and its index, both 0
    }
    for (std::size_t k = 1; k < n; ++k, next()) {
      state[i] = (state[i] ^ (mixed(i) * 1566083941U)) - static_cast<std::uint32_t>(i);
    }
    state[0] = 0x80000000U;
    std::copy(state.begin(), state.end(), begin);
  }
};

/// A number in [0, limit), like Random._randbelow.
std::size_t below(std::mt19937& generator, std::size_t limit) {
  const auto bits = static_cast<unsigned>(std::bit_width(limit));
  while (true) {
    const std::size_t value = generator() >> (32U - bits);
    if (value < limit) return value;
  }
}

}  // namespace

void shuffle_as_python(std::vector<IndexPair>& pairs) {
  PythonSeed seed;
  std::mt19937 generator(seed);
  for (std::size_t i = pairs.size(); i-- > 1;) {
    std::swap(pairs[i], pairs[below(generator, i + 1)]);
  }
}

std::vector<IndexPair> loop_pairs(std::span<const geometry::Pose2> path) {
  std::vector<double> path_m{0.0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    path_m.push_back(path_m.back() + (path[i].position_m() - path[i - 1].position_m()).norm());
  }
  const std::size_t step = std::max<std::size_t>(1, path.size() / kPosesLookedAt);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < path.size(); i += step) {
    for (std::size_t j = i + 1; j < path.size(); j += step) {
      if (path_m[j] - path_m[i] > kPathBetween_m &&
          (path[i].position_m() - path[j].position_m()).norm() < kNear_m) {
        pairs.emplace_back(i, j);
      }
    }
  }
  shuffle_as_python(pairs);
  pairs.resize(std::min(pairs.size(), kMostPairs));
  return pairs;
}

}  // namespace topogeo::pipeline
