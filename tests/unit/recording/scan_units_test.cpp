// Scans in units that ROS does not have.
#include "scan_units.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>

#include "message_file.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr float kInf = std::numeric_limits<float>::infinity();

ros::LaserScan scan_of(double first, double step, std::vector<float> ranges) {
  ros::LaserScan scan;
  scan.header_(ros::header_of("laser", kSecond_ns));
  scan.angle_min_(static_cast<float>(first));
  scan.angle_increment_(static_cast<float>(step));
  scan.angle_max_(static_cast<float>(first + step * (static_cast<double>(ranges.size()) - 1.0)));
  scan.range_max_(30.0F);
  scan.ranges_(std::move(ranges));
  return scan;
}

TEST(ScanUnits, ConvertDegreesThatNoRadiansCanBe) {
  ros::LaserScan scan = scan_of(-180.0, 1.0, std::vector<float>(360, 2.0F));
  EXPECT_TRUE(correct_degrees(scan));
  EXPECT_NEAR(scan.angle_min_(), -std::numbers::pi, 1e-6);
  EXPECT_NEAR(scan.angle_max_(), 179.0 / 180.0 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(scan.angle_increment_(), std::numbers::pi / 180.0, 1e-8);
  ros::LaserScan clockwise = scan_of(135.0, -0.25, std::vector<float>(1081, 2.0F));
  EXPECT_TRUE(correct_degrees(clockwise));
  EXPECT_NEAR(clockwise.angle_increment_(), -std::numbers::pi / 720.0, 1e-8);
}

TEST(ScanUnits, LeaveOtherAnglesAlone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (ros::LaserScan scan :
       {scan_of(-std::numbers::pi, std::numbers::pi / 180.0, std::vector<float>(360, 2.0F)),
        scan_of(0.0, 0.02, std::vector<float>(360, 2.0F)),    // slightly more than a turn
        scan_of(-180.0, 2.0, std::vector<float>(360, 2.0F)),  // two turns in degrees
        scan_of(nan, 1.0, std::vector<float>(360, 2.0F)),
        scan_of(0.0, nan, std::vector<float>(360, 2.0F)), scan_of(0.0, 1.0, {})}) {
    const float step = scan.angle_increment_();
    EXPECT_FALSE(correct_degrees(scan));
    EXPECT_TRUE(scan.angle_increment_() == step || std::isnan(step));
  }
}

TEST(ScanUnits, FindMillimetres) {
  const auto found = [](const std::vector<float>& ranges) {
    RangeUnit unit;
    unit.add(scan_of(0.0, 0.1, ranges));
    return unit.is_millimetres();
  };
  EXPECT_TRUE(found({532.0F, 1270.0F, 8000.0F, 0.0F, kInf}));
  EXPECT_FALSE(found({0.532F, 1.27F, 8.0F}));
  EXPECT_FALSE(found({0.5F, 1.3F, 999.0F, 65533.0F}));  // two numbers for no echo
  EXPECT_FALSE(found({999.0F, 999.0F, 999.0F}));
  EXPECT_FALSE(found({0.0F, kInf, -1.0F}));
  EXPECT_FALSE(found({}));
}

class RecordedUnits : public RecordingFiles {};

TEST_F(RecordedUnits, AreConverted) {
  MessageFile file(path("a.mcap"));
  for (int i = 0; i < 20; ++i) {
    const std::int64_t time_ns = kSecond_ns + i * kSecond_ns / 10;
    file.odometry(time_ns, time_ns, arc_pose(0.1 * i));
    ros::LaserScan scan =
        scan_of(-90.0, 30.0, {500.0F, 1000.0F, 2000.0F, 3000.0F, 4000.0F, 500.0F});
    scan.header_(ros::header_of("laser", time_ns));
    file.scan(scan, time_ns);
  }
  file.close();
  const std::vector<scan::Scan> scans = read_scans(path("a.mcap"));
  ASSERT_EQ(scans.size(), 20U);
  EXPECT_NEAR(scans[0].angle_min_rad, -std::numbers::pi / 2.0, 1e-6);
  EXPECT_NEAR(scans[0].ranges_m[3], 3.0, 1e-6);
  const std::vector<std::string> notes = mounting_in_log(path("a.mcap")).notes;
  EXPECT_THAT(notes, Contains(HasSubstr("the angles of 20 scans are in degrees")));
  EXPECT_THAT(notes, Contains(HasSubstr("the ranges are in millimetres (up to 4000)")));
}

}  // namespace
}  // namespace topogeo::recording
