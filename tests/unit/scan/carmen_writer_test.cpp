#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>

#include "topogeo/scan/carmen_log_writer.hpp"

#include "log_files.hpp"

namespace topogeo::scan {
namespace {

using ::testing::HasSubstr;

Scan example(std::uint64_t sequence, std::size_t beams) {
  Scan scan;
  scan.sequence = sequence;
  scan.stamp_ns = 1134865040000000007 + static_cast<std::int64_t>(sequence) * 200'000'001;
  scan.angle_min_rad = -std::numbers::pi / 2.0;
  scan.angle_step_rad = flaser_angle_step_rad(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    scan.ranges_m.push_back(i % 7 == 3 ? Scan::kNoReturn
                                       : 0.1F + 0.123456F * static_cast<float>(i));
  }
  scan.T_odom_robot = {1.0 / 3.0, -2.0 / 7.0, 3.0 / 11.0};
  return scan;
}

TEST_F(LogFiles, ReadingBackGivesTheSameScans) {
  for (const char* name : {"w.clf", "w.clf.gz"}) {
    for (const std::size_t beams : {180U, 361U}) {
      CarmenLogWriter writer(path(name));
      for (std::uint64_t i = 0; i < 10; ++i) writer.write(example(i, beams));
      writer.close();
      CarmenLogReader reader(path(name));
      const auto scans = read_all(reader);
      ASSERT_EQ(scans.size(), 10U) << reader.statistics().summary();
      for (std::uint64_t i = 0; i < 10; ++i) {
        const Scan expected = example(i, beams);
        EXPECT_EQ(scans[i].sequence, i);
        EXPECT_EQ(scans[i].stamp_ns, expected.stamp_ns);
        EXPECT_EQ(scans[i].angle_min_rad, expected.angle_min_rad);
        EXPECT_EQ(scans[i].angle_step_rad, expected.angle_step_rad);
        EXPECT_EQ(scans[i].T_odom_robot, expected.T_odom_robot);
        EXPECT_EQ(scans[i].ranges_m, expected.ranges_m);
      }
    }
  }
}

TEST_F(LogFiles, TheNameDecidesAboutCompression) {
  CarmenLogWriter(path("w.clf")).write(example(0, 180));
  CarmenLogWriter(path("w.clf.gz")).write(example(0, 180));
  EXPECT_THAT(content_of(path("w.clf")), HasSubstr("\nFLASER 180 0.1 "));
  EXPECT_EQ(content_of(path("w.clf.gz")).substr(0, 2), "\x1f\x8b");
}

TEST_F(LogFiles, WhatFlaserCannotHoldIsRefused) {
  CarmenLogWriter writer(path("w.clf"));
  const auto refused = [&](auto change) {
    Scan scan = example(0, 180);
    change(scan);
    EXPECT_THROW(writer.write(scan), std::invalid_argument);
  };
  refused([](Scan& s) { s.ranges_m.clear(); });
  refused([](Scan& s) { s.angle_min_rad = -2.0; });
  refused([](Scan& s) { s.angle_step_rad *= 0.5; });
  refused([](Scan& s) { s.stamp_ns = -1; });
  refused([](Scan& s) { s.ranges_m[5] = -1.0F; });
  refused([](Scan& s) { s.ranges_m[5] = std::numeric_limits<float>::quiet_NaN(); });
  refused([](Scan& s) { s.ranges_m[5] = std::numeric_limits<float>::infinity(); });
}

TEST_F(LogFiles, AnUnwritableFileIsAnError) {
  EXPECT_THROW(CarmenLogWriter(path("no/such/folder/w.clf")), std::runtime_error);
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  CarmenLogWriter full("/dev/full");
  EXPECT_THROW(full.close(), std::runtime_error);
  EXPECT_THROW(full.write(example(0, 180)), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::scan
