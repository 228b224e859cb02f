// Random numbers that are the same on every machine for a seed: xoshiro256++ (Blackman and Vigna),
// seeded by splitmix64, and normal numbers by Box and Muller on the project's own functions. The
// distributions of the standard library are not used because their output differs between
// libraries.
#pragma once

#include <array>
#include <cstdint>

namespace topogeo::simulation {

class Random {
 public:
  /// Streams of one seed are independent of each other.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  /// 64 random bits.
  std::uint64_t bits();

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform();

  /// Mean 0, standard deviation 1.
  double normal();

 private:
  std::array<std::uint64_t, 4> state_;
};

}  // namespace topogeo::simulation
