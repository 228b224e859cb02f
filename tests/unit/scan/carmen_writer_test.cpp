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

TEST_F(LogFiles, OtherBeamsThanThoseOfFlaserAreReadBackExactly) {
  struct Beams {
    double angle_min_rad;
    double angle_step_rad;
    std::size_t count;
  };
  const double degree_rad = std::numbers::pi / 180.0;
  // 100 degrees of an LMS, 180 degrees slightly off FLASER's by rounding, a whole turn.
  for (const Beams& beams : {Beams{-50.0 * degree_rad, 0.25 * degree_rad, 401},
                             Beams{-90.0 * degree_rad, std::nextafter(0.5 * degree_rad, 1.0), 361},
                             Beams{-std::numbers::pi, degree_rad, 361}}) {
    std::vector<Scan> written;
    CarmenLogWriter writer(path("w.clf"));
    for (std::uint64_t i = 0; i < 3; ++i) {
      written.push_back(example(i, beams.count));
      written.back().angle_min_rad = beams.angle_min_rad;
      written.back().angle_step_rad = beams.angle_step_rad;
      writer.write(written.back());
    }
    writer.close();
    EXPECT_THAT(content_of(path("w.clf")), HasSubstr("\nROBOTLASER1 0 "));
    CarmenLogReader reader(path("w.clf"));
    const auto scans = read_all(reader);
    ASSERT_EQ(scans.size(), 3U) << reader.statistics().summary();
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(scans[i].stamp_ns, written[i].stamp_ns);
      EXPECT_EQ(scans[i].angle_min_rad, beams.angle_min_rad);
      EXPECT_EQ(scans[i].angle_step_rad, beams.angle_step_rad);
      EXPECT_EQ(scans[i].T_odom_robot, written[i].T_odom_robot);
      // Up to the limit of the reader's options, 49.9 m.
      for (std::size_t b = 0; b < beams.count; ++b) {
        const float range_m = written[i].ranges_m[b];
        EXPECT_EQ(scans[i].ranges_m[b], range_m >= 49.9F ? Scan::kNoReturn : range_m);
      }
    }
  }
}

TEST_F(LogFiles, WhatNoLineCanHoldIsRefused) {
  CarmenLogWriter writer(path("w.clf"));
  const auto refused = [&](auto change) {
    Scan scan = example(0, 180);
    change(scan);
    EXPECT_THROW(writer.write(scan), std::invalid_argument);
  };
  refused([](Scan& s) { s.ranges_m.clear(); });
  refused([](Scan& s) { s.ranges_m.assign(CarmenLogReader::kMaxBeams + 1, 1.0F); });
  refused([](Scan& s) { s.angle_min_rad = -7.0; });
  refused([](Scan& s) { s.angle_step_rad = 0.0; });
  refused([](Scan& s) { s.angle_step_rad *= 3.0; });
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
