#include "topogeo/devices/base_limits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace topogeo::devices {
namespace {

double limited(const char* name, double wanted, double largest) {
  if (std::isfinite(wanted) && wanted > 0.0) return std::min(wanted, largest);
  throw std::invalid_argument("base limits: " + std::string(name) + " is " +
                              std::to_string(wanted) + ", not a positive number");
}

}  // namespace

void require_finite(const char* name, double value) {
  if (std::isfinite(value)) return;
  throw std::invalid_argument("base command: " + std::string(name) + " is not a finite number");
}

BaseLimits within(const BaseLimits& limits, const BaseLimits& most) {
  return {limited("linear_mps", limits.linear_mps, most.linear_mps),
          limited("angular_radps", limits.angular_radps, most.angular_radps),
          limited("linear_mps2", limits.linear_mps2, most.linear_mps2),
          limited("angular_radps2", limits.angular_radps2, most.angular_radps2)};
}

BaseVelocity within(const BaseVelocity& velocity, const BaseLimits& limits) {
  const double excess = std::max({1.0, std::abs(velocity.linear_mps) / limits.linear_mps,
                                  std::abs(velocity.angular_radps) / limits.angular_radps});
  return {velocity.linear_mps / excess, velocity.angular_radps / excess};
}

}  // namespace topogeo::devices
