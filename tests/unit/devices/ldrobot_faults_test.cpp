// Every fault of a LDROBOT laser and its line a thousand times: no beam that was not measured,
// every drop counted, and scans again soon after.
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ldrobot_on_line.hpp"
#include "turning_laser_faults.hpp"

namespace topogeo::devices {
namespace {

using simulation::LaserFault;
using LdFault = TurningLaserFault<LdRobotOnLine>;

/// Bytes of another laser, also with a valid checksum of another sweep.
std::vector<std::uint8_t> bytes_of_another_laser(support::Random& random) {
  LdPacket other;
  other.speed_deg_s = static_cast<std::uint16_t>(1800 + random.below(3000));
  other.start_cdeg = static_cast<std::uint16_t>(random.below(kLdTurnCdeg));
  other.end_cdeg = static_cast<std::uint16_t>((other.start_cdeg + 880U) % kLdTurnCdeg);
  other.time_ms = static_cast<std::uint16_t>(random.below(kLdTimeWrap_ms));
  for (LdPoint& point : other.points) point = {12'345, 200};
  return ld_bytes(other);
}

/// The motor needs a second.
void restarted(LdRobotOnLine& laser, support::Random& random) {
  switch_off_and_on(laser, random);
  laser.run_for(1000 * kFaultMs_ns);
}

void slowed(LdRobotOnLine& laser, support::Random& random) {
  laser.emulator.set_turns_hz(5.0 + 0.01 * static_cast<double>(random.below(800)));
}

constexpr std::int64_t kLdAllowed_ns = 500 * kFaultMs_ns;

// A change of speed and a busy host drop nothing; a closed port is reported by the line.
const std::array kLdFaults{
    LdFault{"BadChecksum", struck_by<LdRobotOnLine>(LaserFault::kBadChecksum, 5), kLdAllowed_ns},
    LdFault{"Truncated", struck_by<LdRobotOnLine>(LaserFault::kTruncated, 5), kLdAllowed_ns},
    LdFault{"Noise", struck_by<LdRobotOnLine>(LaserFault::kGarbage, 5), kLdAllowed_ns},
    LdFault{"Doubled", struck_by<LdRobotOnLine>(LaserFault::kDoubled, 5), kLdAllowed_ns},
    LdFault{"Stuck", struck_by<LdRobotOnLine>(LaserFault::kStuckScan, 30), kLdAllowed_ns},
    LdFault{"WrongModel", other_laser<LdRobotOnLine>(bytes_of_another_laser), kLdAllowed_ns},
    LdFault{"Unplugged", unplug_for_a_while<LdRobotOnLine>, kLdAllowed_ns, false},
    LdFault{"Silent", silence_for_a_while<LdRobotOnLine>, kLdAllowed_ns},
    LdFault{"Restarted", restarted, kLdAllowed_ns},
    LdFault{"Slow", slowed, 700 * kFaultMs_ns, false},
    LdFault{"HostFrozen", freeze_host_for_a_while<LdRobotOnLine>, kLdAllowed_ns, false}};

class LdRobotFaults : public testing::TestWithParam<LdFault> {};

TEST_P(LdRobotFaults, AThousandTimes) {
  LdRobotOnLine laser;
  expect_no_wrong_scan(laser, GetParam(), {2000 * kFaultMs_ns, 150 * kFaultMs_ns});
}

INSTANTIATE_TEST_SUITE_P(All, LdRobotFaults, testing::ValuesIn(kLdFaults),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
