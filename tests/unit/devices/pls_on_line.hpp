// A PLS driver and an emulated PLS on a simulated line, in a world that changes from one scan to
// the next, with a check of every scan of the driver.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/devices/pls_driver.hpp"
#include "topogeo/simulation/pls_emulator.hpp"
#include "topogeo/support/random.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {

inline constexpr std::int64_t kMillisecond_ns = 1'000'000;
inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

class PlsOnLine {
 public:
  explicit PlsOnLine(const PlsSettings& settings = {},
                     const simulation::PlsEmulatorSettings& sensor = {}, std::size_t beams = 361)
      : driver(settings),
        emulator(sensor, [this](std::int64_t now_ns) { return measure(now_ns); }),
        line(driver, emulator),
        random_(sensor.seed),
        beams_(beams) {}

  /// Takes the driver's scans and counts those that the sensor did not measure at their stamp.
  void collect() {
    for (LaserScan& scan : driver.take_scans()) {
      if (!was_measured(scan)) ++wrong_scans;
      scan_seen_ns = line.now_ns();
      scans.push_back(std::move(scan));
    }
  }

  void run_for(std::int64_t duration_ns) {
    line.run_until(duration_ns, [this] {
      collect();
      return false;
    });
    collect();
  }

  /// Passes time until the driver has delivered `count` more scans.
  bool run_for_scans(std::size_t count, std::int64_t limit_ns) {
    const std::size_t wanted = scans.size() + count;
    return line.run_until(limit_ns, [&] {
      collect();
      return scans.size() >= wanted;
    });
  }

  /// Starts up and runs until scans come; throws std::logic_error without scans.
  void start() {
    line.plug_in();
    if (!run_for_scans(3, 30 * kSecond_ns)) throw std::logic_error(driver.status().reason);
  }

  PlsDriver driver;
  simulation::PlsEmulator emulator;
  SimulatedLine line;
  std::vector<LaserScan> scans;
  std::size_t wrong_scans = 0;
  std::int64_t scan_seen_ns = 0;  ///< when the last scan was delivered
  bool still = false;             ///< nothing changes in the world

 private:
  /// The port delivers bytes at the end of its period, so a stamp can be late by that.
  static constexpr std::int64_t kStampError_ns = SimulatedLine::kReadPeriod_ns + 50'000;

  /// Scans are delivered soon after they are measured, so older ones are not kept.
  static constexpr std::size_t kRemembered = 500;

  std::vector<float> measure(std::int64_t now_ns) {
    if (measured_.size() > kRemembered) measured_.erase(measured_.begin());
    std::vector<float>& ranges_m = measured_[now_ns];
    if (still && !last_.empty()) {
      ranges_m = last_;
      return ranges_m;
    }
    for (std::size_t i = 0; i < beams_; ++i) {
      // Includes missing returns, and distances whose codes look like the start of a telegram.
      const std::uint64_t code = random_.below(10) == 0 ? 0 : 10 + random_.below(1000);
      ranges_m.push_back(static_cast<float>(code) * 0.01F);
    }
    last_ = ranges_m;
    return ranges_m;
  }

  [[nodiscard]] bool was_measured(const LaserScan& scan) const {
    for (auto it = measured_.lower_bound(scan.stamp_ns - kStampError_ns);
         it != measured_.end() && it->first <= scan.stamp_ns; ++it) {
      if (same(it->second, scan.ranges_m)) return true;
    }
    return false;
  }

  [[nodiscard]] static bool same(const std::vector<float>& a, const std::vector<float>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (std::abs(a[i] - b[i]) > 0.001F) return false;
    }
    return true;
  }

  support::Random random_;
  std::size_t beams_;
  std::map<std::int64_t, std::vector<float>> measured_;
  std::vector<float> last_;
};

}  // namespace topogeo::devices
