// Odometry that cannot be, and a laser that hangs, in logs of each format.
#include <cmath>

#include <gmock/gmock.h>

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using geometry::Pose2;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A robot on an arc of 2 m radius at 0.5 m/s, 100 scans a tenth of a second apart.
std::vector<scan::Scan> long_drive() {
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 100; ++i) {
    scan::Scan scan;
    scan.sequence = static_cast<std::uint64_t>(i);
    scan.stamp_ns = 1'600'000'000'000'000'000 + i * 100'000'000LL;
    scan.angle_min_rad = -0.75;
    scan.angle_step_rad = 0.0625;
    const double turn = 0.025 * (i + 40);
    scan.T_odom_robot = {2.0 * std::sin(turn), 2.0 - 2.0 * std::cos(turn), turn};
    for (int beam = 0; beam < 25; ++beam) {
      scan.ranges_m.push_back(1.0F + 0.1F * static_cast<float>(beam + i % 17));
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

class FaultyOdometry : public RecordingFiles, public testing::WithParamInterface<const char*> {
 protected:
  /// The scans of a log of this drive; its notes are in notes_.
  std::vector<scan::Scan> read(const std::vector<scan::Scan>& drive) {
    LogWriter writer(path(GetParam()), kMounting);
    for (const scan::Scan& scan : drive) writer.write(scan);
    writer.close();
    LogReader reader(path(GetParam()));
    std::vector<scan::Scan> scans;
    while (std::optional<scan::Scan> scan = reader.next()) scans.push_back(*std::move(scan));
    notes_ = reader.statistics().notes;
    repeated_ = reader.statistics().skipped_for(scan::SkipReason::kRepeated);
    return scans;
  }

  std::vector<std::string> notes_;
  std::uint64_t repeated_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Formats, FaultyOdometry,
                         testing::Values("a.clf", "a.mcap", "a.db3", "a.bag"));

void expect_near(const Pose2& a, const Pose2& b) {
  EXPECT_LT(geometry::difference(a, b).norm(), 0.01);
}

TEST_P(FaultyOdometry, IsNoneInASoundDrive) {
  const std::vector<scan::Scan> scans = read(long_drive());
  EXPECT_EQ(scans.size(), 100U);
  EXPECT_EQ(scans.back().odometry_epoch, scans.front().odometry_epoch);
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_EQ(repeated_, 0U);
}

TEST_P(FaultyOdometry, RevealsReadingsThatALaserRepeats) {
  std::vector<scan::Scan> drive = long_drive();
  for (std::size_t i = 41; i < 60; ++i) drive[i].ranges_m = drive[40].ranges_m;
  const std::vector<scan::Scan> scans = read(drive);
  ASSERT_EQ(scans.size(), 81U);
  EXPECT_EQ(repeated_, 19U);
  EXPECT_EQ(scans[40].stamp_ns, drive[40].stamp_ns);
  EXPECT_EQ(scans[41].stamp_ns, drive[60].stamp_ns);
  EXPECT_EQ(scans[41].sequence, 41U);
}

TEST_P(FaultyOdometry, DoesNotBlameARobotThatStands) {
  std::vector<scan::Scan> drive = long_drive();
  for (std::size_t i = 1; i < drive.size(); ++i) {
    drive[i].ranges_m = drive[0].ranges_m;
    drive[i].T_odom_robot = drive[0].T_odom_robot;
  }
  EXPECT_EQ(read(drive).size(), 100U);
}

TEST_P(FaultyOdometry, OfOneMessageMovesNoScan) {
  std::vector<scan::Scan> drive = long_drive();
  for (const std::size_t i : {50U, 70U}) drive[i].T_odom_robot = {};
  const std::vector<scan::Scan> scans = read(drive);
  EXPECT_GE(scans.size(), 98U);
  for (const scan::Scan& scan : scans) {
    const auto number = static_cast<std::size_t>((scan.stamp_ns - drive[0].stamp_ns) / 100'000'000);
    expect_near(scan.T_odom_robot, long_drive()[number].T_odom_robot);
    EXPECT_EQ(scan.odometry_epoch, scans.front().odometry_epoch);
  }
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("2 odometry poses are left out")));
}

TEST_P(FaultyOdometry, AtTheStartIsLeftOut) {
  std::vector<scan::Scan> drive = long_drive();
  for (std::size_t i = 0; i < 3; ++i) drive[i].T_odom_robot = {12345.6, -9876.5, 0.0};
  const std::vector<scan::Scan> scans = read(drive);
  EXPECT_GE(scans.size(), 97U);
  for (const scan::Scan& scan : scans) EXPECT_LT(scan.T_odom_robot.position_m().norm(), 5.0);
}

TEST_P(FaultyOdometry, ThatRestartsBeginsAnEpoch) {
  std::vector<scan::Scan> drive = long_drive();
  const Pose2 T_odom_restart = drive[60].T_odom_robot;
  for (std::size_t i = 60; i < drive.size(); ++i) {
    drive[i].T_odom_robot = geometry::between(T_odom_restart, drive[i].T_odom_robot);
  }
  const std::vector<scan::Scan> scans = read(drive);
  ASSERT_EQ(scans.size(), 100U);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_EQ(scans[i].odometry_epoch, scans.front().odometry_epoch + (i < 60 ? 0 : 1)) << i;
    EXPECT_EQ(scans[i].sequence, i);
    expect_near(scans[i].T_odom_robot, drive[i].T_odom_robot);
  }
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("the odometry restarts 6.0 s after its beginning")));
}

}  // namespace
}  // namespace topogeo::recording
