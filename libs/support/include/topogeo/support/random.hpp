// Random numbers that are the same on every machine and with every standard library.
//
// xoshiro256** (Blackman and Vigna 2018), its state filled by splitmix64 as its authors advise. The
// distributions of <random> differ between standard libraries, so they are not used.
#pragma once

#include <array>
#include <cstdint>

namespace topogeo::support {

class Random {
 public:
  explicit Random(std::uint64_t seed);

  /// 64 random bits.
  std::uint64_t next_u64();

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform();

  /// Uniform in [low, high); `low` itself when both are equal.
  double uniform(double low, double high);

  /// Uniform in 0 ... n - 1, every value equally likely. Throws std::invalid_argument if n is 0.
  std::uint64_t below(std::uint64_t n);

  /// Normally distributed, mean 0 and standard deviation 1 (Box-Muller on the portable functions).
  double normal();

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

/// 64 bits of the machine's entropy, different at each call: for values that must differ between
/// starts, never for a result.
std::uint64_t unrepeatable_u64();

}  // namespace topogeo::support
