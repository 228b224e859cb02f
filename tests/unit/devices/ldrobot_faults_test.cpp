// Every fault of a LDROBOT laser and its line a thousand times: no beam that was not measured,
// every drop counted, and scans again soon after.
#include <array>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "ldrobot_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::LaserFault;

constexpr std::int64_t kLdMs_ns = 1'000'000;

struct LdFault {
  const char* name;
  std::function<void(LdRobotOnLine&, support::Random&)> inject;
  std::int64_t allowed_ns;  ///< until the next scan
};

std::uint64_t all_drops(const LdRobotOnLine& laser) {
  std::uint64_t sum = laser.driver.health().searches;
  for (const auto& [reason, count] : laser.driver.health().drops) sum += count;
  return sum;
}

std::int64_t up_to(support::Random& random, std::int64_t low_ns, std::int64_t high_ns) {
  return low_ns +
         static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(high_ns - low_ns)));
}

void strike(LdRobotOnLine& laser, LaserFault fault, int count) {
  laser.emulator.faults().inject(fault, count);
  while (laser.emulator.faults().pending(fault) > 0) laser.run_for(3 * kLdMs_ns);
}

auto struck_by(LaserFault fault, std::uint64_t most) {
  return [fault, most](LdRobotOnLine& laser, support::Random& random) {
    strike(laser, fault, 1 + static_cast<int>(random.below(most)));
  };
}

/// Bytes of another laser, also with a valid checksum of another sweep.
void wrong_model(LdRobotOnLine& laser, support::Random& random) {
  bool done = false;
  laser.line.set_filter([&](std::vector<std::uint8_t>& bytes) {
    if (done) return;
    LdPacket other;
    other.speed_deg_s = static_cast<std::uint16_t>(1800 + random.below(3000));
    other.start_cdeg = static_cast<std::uint16_t>(random.below(kLdTurnCdeg));
    other.end_cdeg = static_cast<std::uint16_t>((other.start_cdeg + 880U) % kLdTurnCdeg);
    other.time_ms = static_cast<std::uint16_t>(random.below(kLdTimeWrap_ms));
    for (LdPoint& point : other.points) point = {12'345, 200};
    bytes = ld_bytes(other);
    done = true;
  });
  while (!done) laser.run_for(kLdMs_ns);
  laser.line.set_filter({});
}

void unplugged(LdRobotOnLine& laser, support::Random& random) {
  laser.line.unplug();
  laser.run_for(up_to(random, kLdMs_ns, 2000 * kLdMs_ns));
  laser.line.plug_in();
}

void silent(LdRobotOnLine& laser, support::Random& random) {
  laser.emulator.fall_silent(laser.line.now_ns());
  laser.run_for(up_to(random, 50 * kLdMs_ns, 2000 * kLdMs_ns));
  laser.emulator.speak_again(laser.line.now_ns());
}

void restarted(LdRobotOnLine& laser, support::Random& random) {
  laser.emulator.switch_off();
  laser.run_for(up_to(random, kLdMs_ns, 200 * kLdMs_ns));
  laser.emulator.switch_on(laser.line.now_ns());
  laser.run_for(1000 * kLdMs_ns);
}

void slowed(LdRobotOnLine& laser, support::Random& random) {
  laser.emulator.set_turns_hz(5.0 + 0.01 * static_cast<double>(random.below(800)));
}

/// The host reads nothing for a while, then everything at once.
void host_frozen(LdRobotOnLine& laser, support::Random& random) {
  laser.line.freeze_host(true);
  laser.run_for(up_to(random, kLdMs_ns, 300 * kLdMs_ns));
  laser.line.freeze_host(false);
}

const std::array kLdFaults{
    LdFault{"BadChecksum", struck_by(LaserFault::kBadChecksum, 5), 500 * kLdMs_ns},
    LdFault{"Truncated", struck_by(LaserFault::kTruncated, 5), 500 * kLdMs_ns},
    LdFault{"Noise", struck_by(LaserFault::kGarbage, 5), 500 * kLdMs_ns},
    LdFault{"Doubled", struck_by(LaserFault::kDoubled, 5), 500 * kLdMs_ns},
    LdFault{"Stuck", struck_by(LaserFault::kStuckScan, 30), 500 * kLdMs_ns},
    LdFault{"WrongModel", wrong_model, 500 * kLdMs_ns},
    LdFault{"Unplugged", unplugged, 500 * kLdMs_ns},
    LdFault{"Silent", silent, 500 * kLdMs_ns},
    LdFault{"Restarted", restarted, 500 * kLdMs_ns},
    LdFault{"Slow", slowed, 700 * kLdMs_ns},
    LdFault{"HostFrozen", host_frozen, 500 * kLdMs_ns}};

class LdRobotFaults : public testing::TestWithParam<LdFault> {};

TEST_P(LdRobotFaults, AThousandTimes) {
  const LdFault& fault = GetParam();
  support::Random random(3);
  LdRobotOnLine laser;
  laser.line.plug_in();
  ASSERT_TRUE(laser.run_for_scans(3, 2000 * kLdMs_ns));
  // A change of speed and a busy host drop nothing; a closed port is reported by the line.
  const std::string name = fault.name;
  const bool uncounted = name == "Slow" || name == "HostFrozen" || name == "Unplugged";
  std::size_t late = 0;
  std::size_t silently = 0;
  for (int time = 0; time < 1000; ++time) {
    laser.run_for(up_to(random, 0, 150 * kLdMs_ns));
    const std::uint64_t before = all_drops(laser);
    fault.inject(laser, random);
    if (!laser.run_for_scans(1, fault.allowed_ns)) ++late;
    laser.run_for(150 * kLdMs_ns);
    if (!uncounted && all_drops(laser) == before) ++silently;
    laser.scans.clear();
  }
  EXPECT_EQ(laser.wrong_scans, 0U);
  EXPECT_EQ(late, 0U);
  EXPECT_EQ(silently, 0U);
}

INSTANTIATE_TEST_SUITE_P(All, LdRobotFaults, testing::ValuesIn(kLdFaults),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
