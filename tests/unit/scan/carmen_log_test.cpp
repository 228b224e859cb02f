#include <numbers>

#include <gmock/gmock.h>

#include "log_files.hpp"

namespace topogeo::scan {
namespace {

using ::testing::ElementsAre;

constexpr double kPi = std::numbers::pi;

TEST_F(LogFiles, FlaserLineGivesRangesOdometryAndStamp) {
  CarmenLogReader reader(
      plain("FLASER 5 0.50 1.25 2.00 49.89 81.91 7 8 9 -1.5 2.5 0.75 1134865040.234209 b21 "
            "1134865041\n"));
  const auto scan = reader.next();
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->sequence, 0U);
  EXPECT_EQ(scan->stamp_ns, 1134865040234209000);
  EXPECT_THAT(scan->ranges_m, ElementsAre(0.5F, 1.25F, 2.0F, 49.89F, Scan::kNoReturn));
  EXPECT_EQ(scan->T_odom_robot, (geometry::Pose2{-1.5, 2.5, 0.75}));
  EXPECT_DOUBLE_EQ(scan->angle_min_rad, -kPi / 2.0);
  EXPECT_DOUBLE_EQ(scan->angle_step_rad, kPi / 4.0);
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST_F(LogFiles, FlaserStepDependsOnWhetherTheLastBeamIsIncluded) {
  const std::vector<std::pair<int, double>> steps = {
      {180, 1.0}, {181, 1.0}, {360, 0.5}, {361, 0.5}};
  for (const auto& [beams, step_deg] : steps) {
    std::string ranges = "1";
    for (int i = 1; i < beams; ++i) ranges += " 1";
    CarmenLogReader reader(plain(flaser("1.0", ranges, beams)));
    EXPECT_NEAR(reader.next()->angle_step_rad, step_deg * kPi / 180.0, 1e-15) << beams;
  }
}

TEST_F(LogFiles, RobotLaserLineCarriesItsOwnGeometryAndMaximum) {
  CarmenLogReader reader(
      plain("ROBOTLASER1 4 -1.0 2.0 0.5 8.0 0.01 0 5 1.0 2.0 7.99 8.0 0.0 2 11 12 5 5 5 "
            "1.5 -2.5 4.0 0.3 0.1 0.4 0.5 0.6 12.5 host 12.6\n"));
  const auto scan = reader.next();
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->angle_min_rad, -1.0);
  EXPECT_EQ(scan->angle_step_rad, 0.5);
  EXPECT_THAT(scan->ranges_m, ElementsAre(1.0F, 2.0F, 7.99F, Scan::kNoReturn, Scan::kNoReturn));
  EXPECT_EQ(scan->T_odom_robot.x_m, 1.5);
  EXPECT_EQ(scan->T_odom_robot.y_m, -2.5);
  EXPECT_NEAR(scan->T_odom_robot.theta_rad, 4.0 - 2.0 * kPi, 1e-12);
  EXPECT_EQ(scan->stamp_ns, 12'500'000'000);
}

TEST_F(LogFiles, RangeLimitIsAnOption) {
  const auto log = plain(flaser("1.0", "3.99 4.00 4.01 0"));
  CarmenLogReader reader(log, {.range_max_m = 4.0});
  EXPECT_THAT(reader.next()->ranges_m,
              ElementsAre(3.99F, Scan::kNoReturn, Scan::kNoReturn, Scan::kNoReturn));
  EXPECT_THAT([&] { CarmenLogReader(log, {.range_max_m = 0.0}); },
              testing::ThrowsMessage<std::invalid_argument>(testing::StrEq(
                  "key 'scan.range_max_m' = '0': expected number between 0.5 and 1000 m")));
  EXPECT_THROW(CarmenLogReader(log, {.range_max_m = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(CarmenLogReader(log, {.jump_s = -1.0}), std::invalid_argument);
}

TEST_F(LogFiles, StampsKeepEveryDigit) {
  // A double near 1.1e9 s has steps of 240 ns: these two differ by 1 ns.
  CarmenLogReader reader(plain(flaser("1134865040.234209001") + flaser("1134865040.2342090029")));
  EXPECT_EQ(reader.next()->stamp_ns, 1134865040234209001);
  EXPECT_EQ(reader.next()->stamp_ns, 1134865040234209002);
}

TEST_F(LogFiles, OtherLinesAreCountedAndPassedOver) {
  CarmenLogReader reader(plain("# comment\n\nODOM 1 2 3 0 0 0 1.0 host 1.0\nPARAM a b\r\n" +
                               flaser("1.0") + "ODOM 1 2 3 0 0 0 2.0 host 2.0\n" + flaser("2.0")));
  EXPECT_EQ(read_all(reader).size(), 2U);
  const auto& s = reader.statistics();
  EXPECT_EQ(s.lines, 7U);
  EXPECT_EQ(s.laser_lines, 2U);
  EXPECT_EQ(s.scans, 2U);
  EXPECT_EQ(s.comments, 2U);
  EXPECT_EQ(s.odometry_lines, 2U);
  EXPECT_EQ(s.other_lines, 1U);
  EXPECT_EQ(s.skipped_total(), 0U);
  EXPECT_EQ(s.summary(), "2 scans");
}

TEST_F(LogFiles, WindowsLineEndsTabsAndAMissingLastLineEndAreRead) {
  std::string text = flaser("1.0");
  text.insert(text.size() - 1, "\r");
  std::string tabs = flaser("2.0");
  for (char& c : tabs) c = c == ' ' ? '\t' : c;
  const std::string last = flaser("3.0");
  CarmenLogReader reader(plain(text + tabs + last.substr(0, last.size() - 1)));
  EXPECT_EQ(read_all(reader).size(), 3U);
}

TEST_F(LogFiles, PlainAndGzipGiveTheSameScans) {
  std::string text;
  for (int i = 1; i <= 5000; ++i) {
    text += flaser(std::to_string(i) + ".5", "1.00 2.00 3.00 4.00", 4, "1");
  }
  CarmenLogReader a(plain(text));
  CarmenLogReader b(gzip(text));
  EXPECT_EQ(count_scans(path("a.clf")), 5000U);
  EXPECT_EQ(count_scans(path("a.clf.gz")), 5000U);
  const auto from_plain = read_all(a);
  const auto from_gzip = read_all(b);
  ASSERT_EQ(from_plain.size(), 5000U);
  ASSERT_EQ(from_gzip.size(), 5000U);
  for (std::size_t i = 0; i < from_plain.size(); ++i) {
    ASSERT_EQ(from_plain[i].sequence, i);
    ASSERT_EQ(from_gzip[i].sequence, i);
    ASSERT_EQ(from_plain[i].stamp_ns, from_gzip[i].stamp_ns);
    ASSERT_EQ(from_plain[i].T_odom_robot, from_gzip[i].T_odom_robot);
  }
}

TEST_F(LogFiles, FractionReadGrowsToOne) {
  std::string text;
  for (int i = 1; i <= 20000; ++i) text += flaser(std::to_string(i) + ".5");
  CarmenLogReader reader(plain(text));
  EXPECT_LT(reader.fraction_read(), 0.2);
  double before = 0.0;
  while (reader.next()) {
    ASSERT_GE(reader.fraction_read(), before);
    before = reader.fraction_read();
  }
  EXPECT_EQ(reader.fraction_read(), 1.0);
}

struct RealLog {
  const char* file;
  std::size_t scans;
  std::size_t beams;
};

// Printed by the test runner instead of the bytes.
std::ostream& operator<<(std::ostream& out, const RealLog& tested) {
  return out << tested.file;
}

class RealLogs : public ::testing::TestWithParam<RealLog> {};

TEST_P(RealLogs, EveryLineIsUsable) {
  const auto log = std::filesystem::path(TOPOGEO_SOURCE_DIR) / "../shared/data" / GetParam().file;
  if (!std::filesystem::exists(log)) GTEST_SKIP() << log << " is not here";
  CarmenLogReader reader(log);
  const auto scans = read_all(reader);
  EXPECT_EQ(scans.size(), GetParam().scans);
  EXPECT_EQ(count_scans(log), GetParam().scans);
  EXPECT_EQ(reader.statistics().skipped_total(), 0U) << reader.statistics().summary();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    ASSERT_EQ(scans[i].ranges_m.size(), GetParam().beams);
    if (i == 0) continue;
    ASSERT_GT(scans[i].stamp_ns, scans[i - 1].stamp_ns);
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, RealLogs,
                         ::testing::Values(RealLog{"csail.clf.gz", 1223, 361},
                                           RealLog{"intel.clf.gz", 910, 180},
                                           RealLog{"freiburg-079.clf.gz", 1464, 360}));

}  // namespace
}  // namespace topogeo::scan
