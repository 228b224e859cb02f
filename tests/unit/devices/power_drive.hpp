// Ordinary drives of a base on a simulated line with a navigator's commands: starts, stops,
// reversals, slow turns and speeds that change a little with every command.
#pragma once

#include <cmath>
#include <cstdint>

#include "topogeo/devices/base_motion.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {

/// Twenty commands a second. The same seed gives the same commands.
class OrdinaryDrive {
 public:
  static constexpr std::int64_t kPeriod_ns = 50'000'000;

  explicit OrdinaryDrive(std::uint64_t seed) : random_(seed) {}

  BaseVelocity next() {
    if (left_-- <= 0) begin_leg();
    if (ramps_) {
      given_.linear_mps = towards(given_.linear_mps, aim_.linear_mps, 0.02);
      given_.angular_radps = towards(given_.angular_radps, aim_.angular_radps, 0.04);
    } else {
      given_ = aim_;
    }
    // A guard does so near obstacles, because measured distances are noisy.
    const double share = wavers_ ? random_.uniform(0.85, 1.0) : 1.0;
    return {share * given_.linear_mps, share * given_.angular_radps};
  }

 private:
  static double towards(double now, double aim, double most) {
    return now + std::fmin(std::fmax(aim - now, -most), most);
  }

  void begin_leg() {
    left_ = 4 + static_cast<int>(random_.below(60));
    ramps_ = random_.below(2) == 0;
    wavers_ = random_.below(4) == 0;
    switch (random_.below(6)) {
      case 0:
        aim_ = {};
        break;
      case 1:
        aim_ = {-aim_.linear_mps, -aim_.angular_radps};
        break;
      case 2:  // turns on the spot, also slowly
        aim_ = {0.0, std::copysign(random_.uniform(0.05, 0.8), random_.uniform(-1.0, 1.0))};
        break;
      case 3:  // creeps
        aim_ = {random_.uniform(0.01, 0.06), random_.uniform(-0.1, 0.1)};
        break;
      default:
        aim_ = {random_.uniform(-0.3, 0.45), random_.uniform(-0.6, 0.6)};
    }
  }

  support::Random random_;
  BaseVelocity aim_{};
  BaseVelocity given_{};
  int left_ = 0;
  bool ramps_ = false;
  bool wavers_ = false;
};

}  // namespace topogeo::devices
