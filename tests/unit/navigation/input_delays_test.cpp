// Why a robot stands still: an input has ended, or is late because a machine is too busy.
#include "input_delays.hpp"

#include <gmock/gmock.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kNoon = 43'200 * kSecond;
constexpr MachineLoad kBusy{true, 0.4};
constexpr const char* kOld = "the last scan is 1.9 s old";

TEST(InputDelays, ScansThatComeLateNameTheMachine) {
  InputDelays delays;
  delays.set(kBusy);
  delays.add(TimedInput::kScan, kNoon - 18 * kSecond / 10, kNoon);
  const InputDelays::Reason why = delays.explain(HaltReason::kNoScan, kOld, kNoon + kSecond / 10);
  EXPECT_EQ(why.message, "this machine is too busy: scans arrive 1.8 s late");
  EXPECT_TRUE(why.busy_machine);
}

TEST(InputDelays, LateScansOnAFreeMachineComeFromABusyOne) {
  InputDelays delays;
  delays.add(TimedInput::kScan, kNoon - 18 * kSecond / 10, kNoon);
  EXPECT_EQ(delays.explain(HaltReason::kNoScan, kOld, kNoon).message,
            "scans arrive 1.8 s late: the machine that sends them or the network is too busy");
}

TEST(InputDelays, ScansThatHaveGoneAreGone) {
  InputDelays delays;
  delays.add(TimedInput::kScan, kNoon - kSecond / 20, kNoon);
  const InputDelays::Reason why = delays.explain(HaltReason::kNoScan, kOld, kNoon + 2 * kSecond);
  EXPECT_EQ(why.message, kOld);
  EXPECT_FALSE(why.busy_machine);
  // The last ones were late, too, but no more are coming.
  delays.add(TimedInput::kScan, kNoon - 2 * kSecond, kNoon);
  EXPECT_EQ(delays.explain(HaltReason::kNoScan, kOld, kNoon + 2 * kSecond).message, kOld);
}

TEST(InputDelays, ABusyMachineIsNamedWithWhatItMayCauseAndNothingElse) {
  InputDelays delays;
  delays.set(kBusy);
  for (const HaltReason reason :
       {HaltReason::kNoMap, HaltReason::kNoOdometry, HaltReason::kWaitsForRoute,
        HaltReason::kBaseNotReady, HaltReason::kPoseLost}) {
    EXPECT_EQ(delays.explain(reason, "text", kNoon).message,
              "text; this machine is too busy: timers fire up to 0.4 s late");
  }
  for (const HaltReason reason : {HaltReason::kPaused, HaltReason::kCancelled, HaltReason::kNone,
                                  HaltReason::kObstacle, HaltReason::kNoRoute}) {
    EXPECT_EQ(delays.explain(reason, "text", kNoon).message, "text");
  }
}

TEST(InputDelays, APoseKeepsItsOwnReason) {
  InputDelays delays;
  delays.set(kBusy);
  delays.add(TimedInput::kPose, kNoon - 4 * kSecond, kNoon);
  EXPECT_THAT(delays.explain(HaltReason::kPoseLost, "the last pose is 4.0 s old", kNoon).message,
              AllOf(StartsWith("the last pose is 4.0 s old; this machine is too busy"),
                    HasSubstr("poses arrive 4.0 s late")));
}

/// A drive whose scans are late for a while: it stops as fast as without a known cause, names the
/// machine, and continues by itself once they are in time.
TEST(InputDelays, ADriveStopsAndGoesOnByItself) {
  DriveSettings settings;
  settings.T_world_start = {1.0, 1.0, 0.0};
  TestDrive drive(room(), settings);
  drive.go_to({6.5, 4.5});
  ASSERT_TRUE(drive.run_until([&] { return drive.command.linear_m_per_s > 0.3; }, 10.0));
  drive.navigator.set_machine(kBusy);
  drive.scans_come = false;
  ASSERT_TRUE(drive.run_until([&] { return drive.halted(HaltReason::kNoScan); }, 2.0));
  EXPECT_EQ(drive.command, geometry::Velocity{});
  const std::int64_t now_ns = drive.now_ns;
  drive.navigator.note_arrival(TimedInput::kScan, now_ns - 18 * kSecond / 10, now_ns);
  drive.step();
  EXPECT_EQ(drive.status().message, "this machine is too busy: scans arrive 1.8 s late");
  EXPECT_TRUE(drive.status().busy_machine);
  drive.scans_come = true;
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_FALSE(drive.status().busy_machine);
}

}  // namespace
}  // namespace topogeo::navigation
