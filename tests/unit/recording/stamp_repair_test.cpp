// Clocks of recordings that go wrong: each message keeps its place among its neighbours.
#include "stamp_repair.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "message_file.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kStart_ns = 1'700'000'000 * kSecond_ns;
constexpr std::int64_t kYear_ns = 31'536'000 * kSecond_ns;
constexpr std::int64_t kMs_ns = 1'000'000;

/// Messages each `period_ns`, recorded 10 ms after their stamps.
std::vector<StampedMessage> sound(std::size_t count, std::int64_t period_ns) {
  std::vector<StampedMessage> messages;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t stamp_ns = kStart_ns + static_cast<std::int64_t>(i) * period_ns;
    messages.push_back({stamp_ns, stamp_ns + 10 * kMs_ns, i});
  }
  return messages;
}

/// A drive of 20 s: scans at 5 Hz, odometry at 20 Hz.
struct Drive20s {
  std::vector<StampedMessage> scans = sound(100, 200 * kMs_ns);
  std::vector<StampedMessage> odometry = sound(400, 50 * kMs_ns);

  /// Sets the clock of both when `after_s` have passed.
  void set_clock(double after_s, std::int64_t by_ns) {
    const std::int64_t at_ns = kStart_ns + static_cast<std::int64_t>(after_s * 1e9);
    for (auto* stream : {&scans, &odometry}) {
      for (StampedMessage& message : *stream) {
        if (message.stamp_ns > at_ns) message.stamp_ns += by_ns;
      }
    }
  }
};

/// Expects the times of a sound drive within a millisecond; returns the number left out.
std::size_t expect_sound(const std::vector<std::optional<std::int64_t>>& times_ns,
                         std::int64_t period_ns) {
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < times_ns.size(); ++i) {
    if (!times_ns[i]) {
      ++left_out;
      continue;
    }
    const std::int64_t expected_ns = kStart_ns + static_cast<std::int64_t>(i) * period_ns;
    EXPECT_LE(std::llabs(*times_ns[i] - expected_ns), kMs_ns) << i;
  }
  return left_out;
}

TEST(StampRepair, LeavesSoundStampsAlone) {
  Drive20s drive;
  drive.scans[50].log_ns += 5 * kSecond_ns;  // the recorder was busy
  std::swap(drive.odometry[200], drive.odometry[202]);
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    EXPECT_EQ(repaired.scans_ns[i], drive.scans[i].stamp_ns) << i;
  }
  for (std::size_t i = 0; i < drive.odometry.size(); ++i) {
    EXPECT_EQ(repaired.odometry_ns[i], drive.odometry[i].stamp_ns) << i;
  }
  EXPECT_THAT(repaired.notes, IsEmpty());
}

TEST(StampRepair, LeavesAPauseAsItIs) {
  std::vector<StampedMessage> scans = sound(100, 200 * kMs_ns);
  for (std::size_t i = 50; i < 100; ++i) {
    scans[i].stamp_ns += 600 * kSecond_ns;
    scans[i].log_ns += 600 * kSecond_ns;
  }
  const RepairedStamps repaired = repair_stamps(scans, scans);
  EXPECT_EQ(repaired.scans_ns.back(), scans.back().stamp_ns);
  EXPECT_THAT(repaired.notes, IsEmpty());
}

TEST(StampRepair, LeavesOutOneOddStampAlone) {
  for (const std::int64_t odd_ns :
       {kStart_ns + kYear_ns, kStart_ns - kYear_ns, std::int64_t{0}, kStart_ns + 9 * kSecond_ns}) {
    SCOPED_TRACE(odd_ns);
    Drive20s drive;
    drive.odometry[200].stamp_ns = odd_ns;
    const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
    EXPECT_EQ(expect_sound(repaired.scans_ns, 200 * kMs_ns), 0U);
    EXPECT_EQ(expect_sound(repaired.odometry_ns, 50 * kMs_ns), 1U);
    EXPECT_THAT(repaired.notes, Contains(HasSubstr("1 of the odometry messages have odd times")));
  }
}

TEST(StampRepair, DoesNotJudgeByTheFirstStamp) {
  Drive20s drive;
  drive.odometry[0].stamp_ns = 0;
  drive.scans[0].stamp_ns = 0;
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  EXPECT_EQ(expect_sound(repaired.scans_ns, 200 * kMs_ns), 0U);  // by its time of recording
  EXPECT_EQ(expect_sound(repaired.odometry_ns, 50 * kMs_ns), 0U);
}

TEST(StampRepair, TakesSimulatedTimeFromZero) {
  Drive20s drive;
  for (auto* stream : {&drive.scans, &drive.odometry}) {
    for (StampedMessage& message : *stream) message.stamp_ns -= kStart_ns;
  }
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    EXPECT_EQ(repaired.scans_ns[i], static_cast<std::int64_t>(i) * 200 * kMs_ns);
  }
  EXPECT_EQ(repaired.odometry_ns[0], 0);
}

TEST(StampRepair, TakesTimesOfRecordingWithoutStamps) {
  Drive20s drive;
  for (StampedMessage& message : drive.scans) message.stamp_ns = 0;
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  EXPECT_EQ(repaired.scans_ns[7], drive.scans[7].log_ns);
  EXPECT_THAT(repaired.notes, Contains(HasSubstr("the scans have no time stamps")));
}

TEST(StampRepair, GoesOnWhenTheClockIsSet) {
  for (const std::int64_t by_ns :
       {-kSecond_ns / 2, -5 * kSecond_ns, -3600 * kSecond_ns, 3600 * kSecond_ns, kYear_ns}) {
    SCOPED_TRACE(by_ns);
    Drive20s drive;
    drive.set_clock(8.0, by_ns);
    const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
    EXPECT_EQ(expect_sound(repaired.scans_ns, 200 * kMs_ns), 0U);
    EXPECT_EQ(expect_sound(repaired.odometry_ns, 50 * kMs_ns), 0U);
    EXPECT_THAT(repaired.notes, Contains(HasSubstr("the clock is set by")));
  }
}

TEST(StampRepair, TakesScansAndOdometryToTheSameTimeWhateverTheRecorderDelays) {
  Drive20s drive;
  drive.set_clock(8.0, -3600 * kSecond_ns);
  for (StampedMessage& message : drive.scans) {
    message.log_ns += 300 * kMs_ns * static_cast<std::int64_t>(message.content % 3);
  }
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  for (std::size_t i = 41; i < 100; ++i)
    EXPECT_EQ(repaired.scans_ns[i], repaired.odometry_ns[4 * i]);
}

TEST(StampRepair, LeavesOutAGlitchOfBothClocks) {
  Drive20s drive;
  for (auto* stream : {&drive.scans, &drive.odometry}) {
    for (StampedMessage& message : *stream) {
      const std::int64_t after_ns = message.stamp_ns - kStart_ns;
      if (after_ns > 8 * kSecond_ns && after_ns < 9 * kSecond_ns) message.stamp_ns += kYear_ns;
    }
  }
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  EXPECT_EQ(expect_sound(repaired.scans_ns, 200 * kMs_ns), 4U);
  EXPECT_EQ(expect_sound(repaired.odometry_ns, 50 * kMs_ns), 19U);
}

TEST(StampRepair, LeavesOutWhatIsPlayedAgain) {
  Drive20s drive;
  const Drive20s again = drive;
  for (auto [stream, more] :
       {std::pair{&drive.scans, &again.scans}, std::pair{&drive.odometry, &again.odometry}}) {
    for (StampedMessage message : *more) {
      message.log_ns += 30 * kSecond_ns;
      stream->push_back(message);
    }
  }
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  EXPECT_EQ(expect_sound(repaired.scans_ns, 200 * kMs_ns), 100U);
  EXPECT_EQ(expect_sound(repaired.odometry_ns, 50 * kMs_ns), 400U);
  EXPECT_TRUE(repaired.scans_ns[99]);
  EXPECT_EQ(std::ranges::count(repaired.scans_repeated, true), 100);
  EXPECT_THAT(repaired.notes, Contains(HasSubstr("100 of the scans came before")));
}

TEST(StampRepair, SpreadsEqualStampsByTheirOrder) {
  Drive20s drive;
  // Stamps of whole seconds.
  for (StampedMessage& message : drive.scans) message.stamp_ns -= message.stamp_ns % kSecond_ns;
  drive.odometry[7] = drive.odometry[6];  // the same message twice
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  EXPECT_EQ(repaired.odometry_ns[6], drive.odometry[6].stamp_ns);
  EXPECT_FALSE(repaired.odometry_ns[7]);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    ASSERT_TRUE(repaired.scans_ns[i]);
    const std::int64_t expected_ns = kStart_ns + static_cast<std::int64_t>(i) * 200 * kMs_ns;
    EXPECT_LE(std::llabs(*repaired.scans_ns[i] - expected_ns), 20 * kMs_ns) << i;
    EXPECT_TRUE(i == 0 || *repaired.scans_ns[i] > *repaired.scans_ns[i - 1]) << i;
  }
}

TEST(StampRepair, JoinsTwoClocksByTheTimesOfRecording) {
  Drive20s drive;
  for (StampedMessage& message : drive.scans) message.stamp_ns -= kStart_ns - 42 * kSecond_ns;
  const RepairedStamps repaired = repair_stamps(drive.scans, drive.odometry);
  EXPECT_EQ(expect_sound(repaired.scans_ns, 200 * kMs_ns), 0U);
  EXPECT_THAT(repaired.notes, Contains(HasSubstr("the times of two clocks")));
}

TEST(StampRepair, EndsWithAnyNumbers) {
  const std::int64_t last_ns = StampedMessage::kLatest_ns;
  std::vector<StampedMessage> wild;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const std::uint64_t number = (i + 1) * 0x9E3779B97F4A7C15U;
    wild.push_back({static_cast<std::int64_t>(number % static_cast<std::uint64_t>(last_ns)),
                    static_cast<std::int64_t>((number >> 7U) % static_cast<std::uint64_t>(last_ns)),
                    i});
  }
  EXPECT_EQ(repair_stamps(wild, sound(100, kSecond_ns)).scans_ns.size(), wild.size());
  EXPECT_EQ(repair_stamps(sound(100, kSecond_ns), wild).odometry_ns.size(), wild.size());
  EXPECT_THAT(repair_stamps({}, {}).scans_ns, IsEmpty());
}

class RecordedTimes : public RecordingFiles {};

// One odometry message a year ahead, and the clock an hour back in the middle.
TEST_F(RecordedTimes, LoseNoScansToOddStamps) {
  MessageFile file(path("a.mcap"));
  for (int i = 0; i < 200; ++i) {
    const std::int64_t time_ns = kStart_ns + i * kSecond_ns / 10;
    const std::int64_t stamp_ns = time_ns - (i < 100 ? 0 : 3600 * kSecond_ns);
    file.odometry(i == 50 ? stamp_ns + kYear_ns : stamp_ns, time_ns, arc_pose(0.1 * i));
    file.scan(stamp_ns, time_ns, ranges_of(i));
  }
  file.close();
  const std::vector<scan::Scan> scans = read_scans(path("a.mcap"));
  ASSERT_EQ(scans.size(), 200U);
  for (int i = 0; i < 200; ++i) {
    const scan::Scan& scan = scans[static_cast<std::size_t>(i)];
    EXPECT_LT(geometry::difference(scan.T_odom_robot, arc_pose(0.1 * i)).norm(), 0.005) << i;
    EXPECT_EQ(scan.odometry_epoch, scans.front().odometry_epoch);
  }
}

// A transform each 1.11 s, and scans that begin before it.
TEST_F(RecordedTimes, AllowSlowOdometry) {
  MessageFile file(path("a.mcap"));
  for (int i = 0; i < 200; ++i) {
    const std::int64_t time_ns = kStart_ns + i * kSecond_ns / 10;
    if (i % 11 == 5) file.transform("odom", "base_link", arc_pose(0.1 * i), time_ns, "/tf");
    file.scan(time_ns, time_ns, ranges_of(i));
  }
  file.close();
  LogReader reader(path("a.mcap"));
  std::size_t scans = 0;
  while (const std::optional<scan::Scan> scan = reader.next()) {
    const double time_s = static_cast<double>(scan->stamp_ns - kStart_ns) * 1e-9;
    EXPECT_LT(geometry::difference(scan->T_odom_robot, arc_pose(time_s)).norm(), 0.06) << time_s;
    ++scans;
  }
  EXPECT_EQ(scans, 190U);
  const scan::CarmenLogStatistics& statistics = reader.statistics();
  EXPECT_THAT(statistics.notes, Contains(HasSubstr("odometry comes only each 1.10 s")));
  EXPECT_EQ(statistics.skipped_for(scan::SkipReason::kOdometryEnds), 10U);
  EXPECT_THAT(statistics.messages.front(), HasSubstr("no odometry yet: the first comes 0.500 s"));
  EXPECT_EQ(check_log(path("a.mcap")).faults(), 0U);
}

TEST_F(RecordedTimes, AreMissingInAGapOfOdometry) {
  MessageFile file(path("a.mcap"));
  for (int i = 0; i < 200; ++i) {
    const std::int64_t time_ns = kStart_ns + i * kSecond_ns / 10;
    if (i < 100 || i > 140) file.odometry(time_ns, time_ns, arc_pose(0.1 * i));
    file.scan(time_ns, time_ns, ranges_of(i));
  }
  file.close();
  LogReader reader(path("a.mcap"));
  while (reader.next()) {
  }
  EXPECT_EQ(reader.statistics().skipped_for(scan::SkipReason::kNoOdometry), 41U);
  EXPECT_THAT(reader.statistics().messages.front(),
              HasSubstr("got a gap of 4.200 s with a step of"));
  EXPECT_EQ(check_log(path("a.mcap")).count(scan::LogFault::kNoOdometry), 41U);
}

TEST_F(RecordedTimes, AllowAnyOrderOfTopics) {
  constexpr int kMany = 6000;
  const auto write = [&](const std::string& name, const std::vector<int>& parts) {
    MessageFile file(path(name));
    for (const int part : parts) {
      for (int i = 0; i < kMany; ++i) {
        const std::int64_t time_ns = kStart_ns + i * kSecond_ns / 40;
        if (part == 0) file.scan(time_ns, time_ns, ranges_of(i));
        if (part == 1) file.odometry(time_ns, time_ns, arc_pose(i / 40.0));
      }
    }
    file.close();
    return read_scans(path(name));
  };
  const std::vector<scan::Scan> scans_first = write("a.mcap", {0, 1});
  ASSERT_EQ(scans_first.size(), std::size_t{kMany});
  expect_same_scans(scans_first, write("b.mcap", {1, 0}));
}

}  // namespace
}  // namespace topogeo::recording
