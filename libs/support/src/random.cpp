#include "topogeo/support/random.hpp"

#include <bit>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::support {

Random::Random(std::uint64_t seed) {
  constexpr std::uint64_t kSplitmixStep = 0x9e3779b97f4a7c15ULL;
  for (std::uint64_t& word : state_) {
    word = splitmix64(seed);
    seed += kSplitmixStep;
  }
}

std::uint64_t Random::next_u64() {
  const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() {
  return static_cast<double>(next_u64() >> 11) * 0x1.0p-53;
}

double Random::uniform(double low, double high) {
  const double value = low + (high - low) * uniform();
  return value < high ? value : low;  // rounding may reach `high`, which is outside the interval
}

std::uint64_t Random::below(std::uint64_t n) {
  if (n == 0) throw std::invalid_argument("Random::below: n is 0, expected at least 1");
  // The first 2^64 mod n values would make small results likelier, so they are redrawn.
  const std::uint64_t biased = (0 - n) % n;
  std::uint64_t value = next_u64();
  while (value < biased) value = next_u64();
  return value % n;
}

double Random::normal() {
  if (has_spare_normal_) {
    has_spare_normal_ = false;
    return spare_normal_;
  }
  const double u = 1.0 - uniform();  // in (0, 1], so that the logarithm exists
  const double radius = std::sqrt(-2.0 * geometry::log(u));
  const auto direction = geometry::sincos(2.0 * std::numbers::pi * uniform());
  spare_normal_ = radius * direction.sin;
  has_spare_normal_ = true;
  return radius * direction.cos;
}

std::uint64_t unrepeatable_u64() {
  std::random_device random;
  return (std::uint64_t{random()} << 32U) | random();
}

}  // namespace topogeo::support
