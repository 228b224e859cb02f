// The beams that a turning laser has measured: random ranges with their time, as the oracle for
// the scans of its driver.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <numbers>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {

class MeasuredBeams {
 public:
  explicit MeasuredBeams(std::uint64_t seed) : random_(seed) {}

  /// Ranges of 0.3 to 10 m in any order; one in ten is no return.
  std::vector<float> measure(const simulation::BeamPattern& beams, std::int64_t now_ns) {
    std::vector<float> ranges_m;
    for (std::size_t i = 0; i < beams.count; ++i) {
      const auto code = random_.below(10) == 0 ? 0 : 300 + random_.below(9700);
      ranges_m.push_back(static_cast<float>(code) * 0.001F);
      const double angle_rad = beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad;
      beams_.push_back({wrapped(angle_rad), ranges_m.back(), now_ns});
    }
    while (beams_.front().time_ns < now_ns - kRemembered_ns) beams_.pop_front();
    return ranges_m;
  }

  /// Whether each range of the scan lies at, or between two neighbours on one surface of, what was
  /// measured in its direction at its time.
  [[nodiscard]] bool has(const LaserScan& scan) const {
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (scan.ranges_m[i] > 0.0F && !has(scan, i)) return false;
    }
    return true;
  }

  /// Longest time between a measurement and the stamp of its beam: packets, the period of the port
  /// and whole milliseconds of the laser's clock.
  std::int64_t time_error_ns = 6'000'000;

 private:
  struct Measured {
    double angle_rad;  // -pi to pi
    float range_m;
    std::int64_t time_ns;
  };
  static constexpr std::int64_t kRemembered_ns = 3'000'000'000;
  static constexpr double kTurn_rad = 2.0 * std::numbers::pi;

  static double wrapped(double angle_rad) { return std::remainder(angle_rad, kTurn_rad); }

  [[nodiscard]] bool has(const LaserScan& scan, std::size_t beam) const {
    constexpr float kSame_m = 0.005F;
    constexpr float kOneSurface_m = 0.2F;
    const auto place = static_cast<double>(beam);
    const double angle_rad = wrapped(scan.angle_min_rad + place * scan.angle_step_rad);
    const std::int64_t time_ns =
        scan.stamp_ns + std::llround(1e9 * (scan.first_beam_s + place * scan.time_step_s));
    const auto from =
        std::ranges::lower_bound(beams_, time_ns - time_error_ns, {}, &Measured::time_ns);
    const float range_m = scan.ranges_m[beam];
    std::vector<float> near_m;
    for (auto it = from; it != beams_.end() && it->time_ns <= time_ns + time_error_ns; ++it) {
      const double apart_rad = std::fabs(it->angle_rad - angle_rad);
      const double shorter_way_rad = std::min(apart_rad, kTurn_rad - apart_rad);
      if (shorter_way_rad > 1.55 * scan.angle_step_rad || it->range_m <= 0.0F) continue;
      if (std::fabs(range_m - it->range_m) <= kSame_m) return true;
      near_m.push_back(it->range_m);
    }
    for (const float a_m : near_m) {
      for (const float b_m : near_m) {
        const bool between =
            range_m >= std::min(a_m, b_m) - kSame_m && range_m <= std::max(a_m, b_m) + kSame_m;
        if (between && std::fabs(a_m - b_m) <= kOneSurface_m) return true;
      }
    }
    return false;
  }

  support::Random random_;
  std::deque<Measured> beams_;
};

}  // namespace topogeo::devices
