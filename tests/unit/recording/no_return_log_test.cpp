// A laser that reports a range for no echo, in logs of each format.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "topogeo/recording/convert.hpp"

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::Each;
using testing::Lt;

constexpr float kNoEcho_m = 8.187F;

/// Straight on past walls of all distances, 60 scans; a fifth of the beams gets no echo.
std::vector<scan::Scan> drive_without_echoes() {
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 60; ++i) {
    scan::Scan scan;
    scan.sequence = static_cast<std::uint64_t>(i);
    scan.stamp_ns = 1'600'000'000'000'000'000 + i * 100'000'000LL;
    scan.angle_min_rad = -0.75;
    scan.angle_step_rad = 0.0625;
    scan.T_odom_robot = {0.1 * i, 0.0, 0.0};
    for (int beam = 0; beam < 25; ++beam) {
      const float range_m = 1.0F + std::fmod(0.37F * static_cast<float>(7 * i + beam), 6.0F);
      scan.ranges_m.push_back((i + beam) % 5 == 0 ? kNoEcho_m : range_m);
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

class NoReturnLog : public RecordingFiles, public testing::WithParamInterface<const char*> {
 protected:
  std::filesystem::path write() {
    LogWriter writer(path(GetParam()), kMounting);
    for (const scan::Scan& scan : drive_without_echoes()) writer.write(scan);
    writer.close();
    return path(GetParam());
  }
};

INSTANTIATE_TEST_SUITE_P(Formats, NoReturnLog,
                         testing::Values("a.clf", "a.mcap", "a.db3", "a.bag"));

TEST_P(NoReturnLog, HasNoReadingsOfThatValue) {
  const auto file = write();
  const LogReader reader(file);
  ASSERT_TRUE(reader.no_return());
  EXPECT_NEAR(reader.no_return()->range_m, kNoEcho_m, 1e-6);
  EXPECT_NEAR(reader.no_return()->share, 0.2, 1e-6);
  const std::vector<scan::Scan> drive = drive_without_echoes();
  const std::vector<scan::Scan> scans = read_scans(file);
  ASSERT_EQ(scans.size(), drive.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_THAT(scans[i].ranges_m, Each(Lt(kNoEcho_m)));
    EXPECT_EQ(std::ranges::count(scans[i].ranges_m, scan::Scan::kNoReturn), 5);
  }
}

TEST_P(NoReturnLog, HasNoneWithoutOdometryEither) {
  LogWriter writer(path(GetParam()), kMounting);
  for (scan::Scan scan : drive_without_echoes()) {
    scan.T_odom_robot = {};
    writer.write(scan);
  }
  writer.close();
  const LogReader reader(path(GetParam()));
  ASSERT_TRUE(reader.no_return());
  EXPECT_NEAR(reader.no_return()->range_m, kNoEcho_m, 1e-6);
}

TEST_P(NoReturnLog, KeepsThemIfToldTo) {
  LogReader reader(write(), {.detect_no_return = false});
  EXPECT_FALSE(reader.no_return());
  EXPECT_EQ(std::ranges::count(reader.next()->ranges_m, kNoEcho_m), 5);
}

TEST_P(NoReturnLog, IsConvertedAsItIs) {
  const auto file = write();
  for (const char* name : {"b.clf", "b.mcap", "b.bag"}) {
    convert(file, path(name));
    const LogReader converted(path(name));
    ASSERT_TRUE(converted.no_return()) << name;
    expect_same_scans(read_scans(path(name)), read_scans(file));
  }
}

TEST_P(NoReturnLog, IsNamedByTheCheck) {
  const scan::LogCheck check = check_log(write());
  ASSERT_TRUE(check.no_return);
  EXPECT_NEAR(check.no_return->range_m, kNoEcho_m, 1e-6);
  EXPECT_EQ(check.faults(), 0U);
}

}  // namespace
}  // namespace topogeo::recording
