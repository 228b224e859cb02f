#include "pls_faults.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>

#include "pls_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::PlsFault;

/// Returns the time when the fault is over.
using Inject = std::function<std::int64_t(PlsOnLine&, support::Random&)>;
using Count = std::uint64_t (*)(const PlsStatus&);

struct Fault {
  const char* name;
  const char* counted_as;
  Count count;
  Inject inject;
  std::int64_t allowed_ns;  ///< 0: two scan periods
};

std::int64_t between(support::Random& random, std::int64_t low_ns, std::int64_t high_ns) {
  return low_ns +
         static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(high_ns - low_ns)));
}

/// Applies the fault to some of the next telegrams.
std::int64_t strike(PlsOnLine& pls, PlsFault fault, int count) {
  pls.emulator.inject(fault, count);
  const bool struck = pls.line.run_until(100 * kSecond_ns, [&] {
    pls.collect();
    return pls.emulator.pending(fault) == 0;
  });
  if (!struck) throw std::logic_error("the fault did not strike");
  return pls.emulator.fault_end_ns();
}

Inject struck_by(PlsFault fault, std::uint64_t most) {
  return [fault, most](PlsOnLine& pls, support::Random& random) {
    return strike(pls, fault, 1 + static_cast<int>(random.below(most)));
  };
}

Inject silent_for(std::int64_t low_ns, std::int64_t high_ns) {
  return [=](PlsOnLine& pls, support::Random& random) {
    pls.emulator.fall_silent(pls.line.now_ns());
    pls.run_for(between(random, low_ns, high_ns));
    pls.emulator.speak_again(pls.line.now_ns());
    return pls.line.now_ns();
  };
}

std::int64_t unplug(PlsOnLine& pls, support::Random& random) {
  pls.line.unplug();
  pls.run_for(between(random, kMillisecond_ns, 3 * kSecond_ns));
  pls.line.plug_in();
  return pls.line.now_ns();
}

std::int64_t restart(PlsOnLine& pls, support::Random& /*random*/) {
  pls.emulator.switch_on(pls.line.now_ns());
  pls.run_for(pls.emulator.fault_end_ns() - pls.line.now_ns());
  return pls.line.now_ns();
}

std::int64_t restart_without_following(PlsOnLine& pls, support::Random& random) {
  pls.emulator.inject(PlsFault::kIgnoreBaudSwitch, 1);
  return restart(pls, random);
}

/// Damages the replies while the sensor is set up, too.
std::int64_t restart_with_bad_replies(PlsOnLine& pls, support::Random& random) {
  constexpr std::array kFaults{PlsFault::kBadCrc, PlsFault::kTruncated, PlsFault::kGarbage};
  pls.emulator.switch_on(pls.line.now_ns());
  pls.run_for(pls.emulator.fault_end_ns() - pls.line.now_ns() - kMillisecond_ns);
  const PlsFault fault = kFaults[random.below(kFaults.size())];
  return strike(pls, fault, 1 + static_cast<int>(random.below(4)));
}

/// Flips a bit anywhere on the line, also in the header of a telegram.
std::int64_t flip_bit(PlsOnLine& pls, support::Random& random) {
  bool flipped = false;
  pls.run_for(between(random, 0, 40 * kMillisecond_ns));
  pls.line.set_filter([&](std::vector<std::uint8_t>& bytes) {
    if (flipped || bytes.empty()) return;
    bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1U << random.below(8));
    flipped = true;
  });
  pls.line.run_until(10 * kSecond_ns, [&] {
    pls.collect();
    return flipped;
  });
  pls.line.set_filter({});
  return pls.line.now_ns();
}

std::uint64_t line_drops(const PlsStatus& status) {
  const SickCounters& line = status.counters.line;
  return line.bad_crc + line.truncated + line.implausible_length + line.noise_bytes;
}
std::uint64_t bad_crc(const PlsStatus& status) {
  return status.counters.line.bad_crc;
}
std::uint64_t noise(const PlsStatus& status) {
  const SickCounters& line = status.counters.line;
  return line.noise_bytes + line.implausible_length + line.truncated + line.acks + line.naks;
}
std::uint64_t stuck(const PlsStatus& status) {
  return status.counters.scan_drops.stuck;
}
std::uint64_t silences(const PlsStatus& status) {
  return status.counters.silences;
}
std::uint64_t openings(const PlsStatus& status) {
  return status.counters.openings;
}
std::uint64_t switches(const PlsStatus& status) {
  return status.counters.switches_not_followed;
}
/// A silence shorter than the timeout drops only the telegram that it interrupted.
std::uint64_t anything(const PlsStatus& /*status*/) {
  static std::uint64_t calls = 0;
  return ++calls;
}

std::vector<Fault> faults(std::int64_t scan_period_ns) {
  const std::int64_t patience_ns = std::max(kSecond_ns, 4 * scan_period_ns);
  return {
      {"bad CRC", "bad_crc", bad_crc, struck_by(PlsFault::kBadCrc, 5), 0},
      {"truncated telegram", "truncated, bad_crc, implausible_length, noise_bytes", line_drops,
       struck_by(PlsFault::kTruncated, 5), 0},
      {"garbage between telegrams", "noise_bytes, implausible_length, truncated, acks, naks", noise,
       struck_by(PlsFault::kGarbage, 5), 0},
      {"a bit flipped anywhere", "bad_crc, truncated, implausible_length, noise_bytes", line_drops,
       flip_bit, 0},
      {"stuck scan", "scan_drops.stuck", stuck, struck_by(PlsFault::kStuckScan, 50), 0},
      {"silence below the limit", "", anything,
       silent_for(scan_period_ns / 4, patience_ns - 2 * scan_period_ns), 0},
      {"silence up to 10 s", "silences", silences,
       silent_for(patience_ns + scan_period_ns, 10 * kSecond_ns), kSecond_ns},
      {"port unplugged", "openings", openings, unplug, 0},
      {"sensor restarts", "silences", silences, restart, kSecond_ns},
      {"restart, rate not followed", "switches_not_followed", switches, restart_without_following,
       4 * kSecond_ns},
      {"restart, bad replies", "bad_crc, truncated, implausible_length, noise_bytes", line_drops,
       restart_with_bad_replies, 10 * kSecond_ns},
  };
}

std::int64_t scan_period_ns(std::uint32_t baud) {
  return std::max(PlsSettings{}.scan_period_ns, line_time_ns(732, {baud, Parity::kEven}));
}

PlsSettings settings_for(std::uint32_t baud) {
  PlsSettings settings;
  settings.baud = baud;
  // The world of the tests changes with every scan, so any repetition is a fault.
  settings.stuck_scans = 2;
  return settings;
}

}  // namespace

std::vector<PlsFaultTest> pls_fault_tests(std::uint32_t baud) {
  std::vector<PlsFaultTest> tests;
  const std::int64_t period_ns = scan_period_ns(baud);
  for (const Fault& fault : faults(period_ns)) {
    tests.push_back(
        {fault.name, fault.counted_as, fault.allowed_ns == 0 ? 2 * period_ns : fault.allowed_ns});
  }
  return tests;
}

PlsFaultResult run_pls_fault(const PlsFaultTest& test, std::uint32_t baud, std::size_t times,
                             std::uint64_t seed) {
  const std::vector<Fault> all = faults(scan_period_ns(baud));
  const auto fault = std::ranges::find(all, test.name, &Fault::name);
  if (fault == all.end()) throw std::invalid_argument("no fault is called " + test.name);
  support::Random random(seed);
  simulation::PlsEmulatorSettings sensor;
  sensor.seed = seed;
  PlsOnLine pls(settings_for(baud), sensor);
  pls.start();
  PlsFaultResult result;
  for (result.times = 0; result.times < times; ++result.times) {
    pls.run_for(between(random, 0, 3 * scan_period_ns(baud)));
    const std::uint64_t counted = fault->count(pls.driver.status());
    const std::int64_t end_ns = fault->inject(pls, random);
    pls.run_for(std::max<std::int64_t>(0, end_ns - pls.line.now_ns()));
    if (!pls.run_for_scans(1, 100 * kSecond_ns)) throw std::logic_error("no recovery");
    const std::int64_t recovery_ns = pls.line.now_ns() - end_ns;
    result.worst_recovery_ns = std::max(result.worst_recovery_ns, recovery_ns);
    if (recovery_ns > test.allowed_ns) ++result.late;
    // Bytes dropped with a false start of a telegram are counted at its end.
    pls.run_for(scan_period_ns(baud) * 2);
    if (fault->count(pls.driver.status()) == counted) ++result.uncounted;
    result.scans += pls.scans.size();
    pls.scans.clear();
  }
  result.wrong_scans = pls.wrong_scans;
  return result;
}

}  // namespace topogeo::devices
