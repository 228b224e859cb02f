// Strikes a turning laser and its line with each fault a thousand times: every beam was measured,
// every drop is counted, and scans arrive again soon.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::devices {

inline constexpr std::int64_t kFaultMs_ns = 1'000'000;

/// `Line`: a TurningLaserOnLine.
template <class Line>
struct TurningLaserFault {
  const char* name;
  std::function<void(Line&, support::Random&)> inject;
  std::int64_t allowed_ns;  ///< until the next scan
  bool counted = true;      ///< in the drops of the driver
};

inline std::int64_t fault_time(support::Random& random, std::int64_t low_ns, std::int64_t high_ns) {
  return low_ns +
         static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(high_ns - low_ns)));
}

/// The emulator damages some of its next packets.
template <class Line>
auto struck_by(simulation::LaserFault fault, std::uint64_t most) {
  return [fault, most](Line& laser, support::Random& random) {
    laser.emulator.faults().inject(fault, 1 + static_cast<int>(random.below(most)));
    while (laser.emulator.faults().pending(fault) > 0) laser.run_for(3 * kFaultMs_ns);
  };
}

/// Bytes of another laser arrive once in place of its own.
template <class Line>
auto other_laser(const std::function<std::vector<std::uint8_t>(support::Random&)>& other_bytes) {
  return [other_bytes](Line& laser, support::Random& random) {
    bool done = false;
    laser.line.set_filter([&](std::vector<std::uint8_t>& bytes) {
      if (done || bytes.empty()) return;
      bytes = other_bytes(random);
      done = true;
    });
    // NOLINTNEXTLINE(bugprone-infinite-loop): the filter ends it
    while (!done) laser.run_for(kFaultMs_ns);
    laser.line.set_filter({});
  };
}

template <class Line>
void unplug_for_a_while(Line& laser, support::Random& random) {
  laser.line.unplug();
  laser.run_for(fault_time(random, kFaultMs_ns, 2000 * kFaultMs_ns));
  laser.line.plug_in();
}

template <class Line>
void silence_for_a_while(Line& laser, support::Random& random) {
  laser.emulator.fall_silent(laser.line.now_ns());
  laser.run_for(fault_time(random, 50 * kFaultMs_ns, 2000 * kFaultMs_ns));
  laser.emulator.speak_again(laser.line.now_ns());
}

template <class Line>
void switch_off_and_on(Line& laser, support::Random& random) {
  laser.emulator.switch_off();
  laser.run_for(fault_time(random, kFaultMs_ns, 200 * kFaultMs_ns));
  laser.emulator.switch_on(laser.line.now_ns());
}

/// The host reads nothing for a while, then everything at once.
template <class Line>
void freeze_host_for_a_while(Line& laser, support::Random& random) {
  laser.line.freeze_host(true);
  laser.run_for(fault_time(random, kFaultMs_ns, 300 * kFaultMs_ns));
  laser.line.freeze_host(false);
}

/// The faults of each turning laser. `other_bytes` are those of another laser.
template <class Line>
std::vector<TurningLaserFault<Line>> turning_laser_faults(
    const std::function<std::vector<std::uint8_t>(support::Random&)>& other_bytes,
    std::int64_t allowed_ns, std::int64_t after_power_ns) {
  using simulation::LaserFault;
  const auto slowed = [](Line& laser, support::Random& random) {
    laser.emulator.set_turns_hz(laser.slowest_hz + 0.01 * static_cast<double>(random.below(100)) *
                                                       (laser.fastest_hz - laser.slowest_hz));
  };
  return {{"BadChecksum", struck_by<Line>(LaserFault::kBadChecksum, 5), allowed_ns},
          {"Truncated", struck_by<Line>(LaserFault::kTruncated, 5), allowed_ns},
          {"Noise", struck_by<Line>(LaserFault::kGarbage, 5), allowed_ns},
          {"Doubled", struck_by<Line>(LaserFault::kDoubled, 5), allowed_ns},
          {"Stuck", struck_by<Line>(LaserFault::kStuckScan, 30), allowed_ns},
          {"WrongModel", other_laser<Line>(other_bytes), allowed_ns},
          {"Unplugged", unplug_for_a_while<Line>, after_power_ns, false},
          {"Silent", silence_for_a_while<Line>, after_power_ns},
          {"Restarted", switch_off_and_on<Line>, after_power_ns},
          {"Slow", slowed, allowed_ns, false},
          {"HostFrozen", freeze_host_for_a_while<Line>, allowed_ns, false}};
}

struct FaultTimes {
  std::int64_t start_ns = 5000 * kFaultMs_ns;  ///< allowed for the first scans
  std::int64_t settle_ns = 200 * kFaultMs_ns;  ///< after a fault, until its drops are counted
};

/// Strikes a running laser a thousand times.
template <class Line>
void expect_no_wrong_scan(Line& laser, const TurningLaserFault<Line>& fault,
                          const FaultTimes& times = {}) {
  support::Random random(3);
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, times.start_ns)) << laser.driver.health().reason;
  const auto drops = [&laser] {
    const LaserHealth health = laser.driver.health();
    std::uint64_t sum = health.searches;
    for (const auto& [reason, count] : health.drops) sum += count;
    return sum;
  };
  std::size_t late = 0;
  std::size_t silently = 0;
  for (int time = 0; time < 1000; ++time) {
    laser.run_for(fault_time(random, 0, 200 * kFaultMs_ns));
    const std::uint64_t before = drops();
    fault.inject(laser, random);
    if (!laser.run_for_scans(1, fault.allowed_ns)) ++late;
    laser.run_for(times.settle_ns);
    if (fault.counted && drops() == before) ++silently;
    laser.scans.clear();
  }
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_EQ(late, 0U);
  EXPECT_EQ(silently, 0U);
}

}  // namespace topogeo::devices
