// Faults of the telegrams of an emulated laser, on demand.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

class TelegramFaults {
 public:
  /// `seed`: of the places of faults.
  explicit TelegramFaults(std::uint64_t seed) : random_(seed) {}

  /// Applies the fault to the next `count` telegrams.
  void inject(LaserFault fault, int count) { pending_[index(fault)] += count; }
  /// Applies the fault to every telegram from now on, or to none.
  void set(LaserFault fault, bool on);
  /// Number of faults still to come.
  [[nodiscard]] int pending(LaserFault fault) const { return pending_[index(fault)]; }
  /// The bytes on the line in place of a telegram (not empty).
  [[nodiscard]] std::vector<std::uint8_t> apply(std::vector<std::uint8_t> telegram);

 private:
  [[nodiscard]] static std::size_t index(LaserFault fault) {
    return static_cast<std::size_t>(fault);
  }
  [[nodiscard]] bool strikes(LaserFault fault);

  support::Random random_;
  std::array<int, kLaserFaults> pending_{};
  std::vector<std::uint8_t> last_;  // without its faults
};

}  // namespace topogeo::simulation
