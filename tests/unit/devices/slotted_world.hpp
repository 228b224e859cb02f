// A round wall around a laser that is somewhere else in each slot of time: the oracle for lasers
// whose readings and directions depend on each other. Within a slot the range is a smooth function
// of the direction, as their emulators need.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/simulation/laser.hpp"

namespace topogeo::devices {

class SlottedWorld {
 public:
  explicit SlottedWorld(std::uint64_t seed) : seed_(seed) {}

  [[nodiscard]] std::vector<float> measure(const simulation::BeamPattern& beams,
                                           std::int64_t now_ns) const {
    std::vector<float> ranges_m;
    for (std::size_t i = 0; i < beams.count; ++i) {
      const double angle_rad = beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad;
      ranges_m.push_back(static_cast<float>(middle_m(now_ns) + wave_m(angle_rad)));
    }
    return ranges_m;
  }

  /// Whether each return lies where the wall was at about its time.
  [[nodiscard]] bool has(const LaserScan& scan) const {
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (scan.ranges_m[i] > 0.0F && !has(scan, i)) return false;
    }
    return true;
  }

  /// Longest time between a measurement and the stamp of its beam.
  std::int64_t time_error_ns = 16'000'000;

 private:
  static constexpr std::int64_t kSlot_ns = 60'000'000;
  static constexpr double kSame_m = 0.03;

  /// Mean range of the slot.
  [[nodiscard]] double middle_m(std::int64_t now_ns) const {
    // SplitMix64 of the slot, as metres.
    std::uint64_t x = seed_ + 0x9E3779B97F4A7C15U * static_cast<std::uint64_t>(now_ns / kSlot_ns);
    x = (x ^ x >> 30U) * 0xBF58476D1CE4E5B9U;
    x = (x ^ x >> 27U) * 0x94D049BB133111EBU;
    return 1.0 + 3.0 * std::ldexp(static_cast<double>(x >> 11U), -53);
  }

  static double wave_m(double angle_rad) { return 0.3 * std::sin(3.0 * angle_rad); }

  [[nodiscard]] bool has(const LaserScan& scan, std::size_t beam) const {
    const auto place = static_cast<double>(beam);
    const double angle_rad = scan.angle_min_rad + place * scan.angle_step_rad;
    const std::int64_t time_ns =
        scan.stamp_ns + std::llround(1e9 * (scan.first_beam_s + place * scan.time_step_s));
    const double at_angle_m = wave_m(angle_rad);
    const std::array walls_m = {middle_m(time_ns - time_error_ns) + at_angle_m,
                                middle_m(time_ns) + at_angle_m,
                                middle_m(time_ns + time_error_ns) + at_angle_m};
    const double range_m = scan.ranges_m[beam];
    if (std::ranges::any_of(
            walls_m, [&](double wall_m) { return std::fabs(wall_m - range_m) <= kSame_m; })) {
      return true;
    }
    // Between two beams on one surface, of which the wall moved by little.
    const auto [nearest, farthest] = std::ranges::minmax(walls_m);
    constexpr double kOneSurface_m = 0.2;
    return farthest - nearest <= kOneSurface_m + 2.0 * kSame_m && range_m >= nearest &&
           range_m <= farthest;
  }

  std::uint64_t seed_;
};

}  // namespace topogeo::devices
