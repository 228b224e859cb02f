#include "sensor_gateway/scan_gate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::sensor_gateway {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kTolerance = 1e-12;

devices::LaserScan scan_at(std::int64_t stamp_ns, std::size_t beams = 3) {
  devices::LaserScan scan;
  scan.stamp_ns = stamp_ns;
  scan.angle_min_rad = -1.0;
  scan.angle_step_rad = 0.1;
  // All scans differ, as with a real laser.
  scan.ranges_m.assign(beams, 2.0F + static_cast<float>(stamp_ns) * 1e-9F);
  return scan;
}

TEST(ScanGate, ScansAreNumberedFromWhenSomebodyReads) {
  ScanGate gate({.has_base = false});
  gate.add(scan_at(1), 1);
  EXPECT_TRUE(gate.take(1).empty());
  EXPECT_EQ(gate.dropped(ScanDrop::kNoReader), 1U);
  gate.open();
  gate.add(scan_at(2), 2);
  gate.add(scan_at(3), 3);
  const auto scans = gate.take(3);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].scan.sequence, 0U);
  EXPECT_EQ(scans[1].scan.sequence, 1U);
  EXPECT_EQ(scans[1].scan.stamp_ns, 3);
  EXPECT_EQ(scans[1].scan.T_odom_robot, geometry::Pose2{});  // no base
}

TEST(ScanGate, WithoutABaseTheTimesOfTheBeamsStay) {
  ScanGate gate({.has_base = false});
  gate.open();
  devices::LaserScan scan = scan_at(2);
  scan.first_beam_s = 0.05;
  scan.time_step_s = -0.001;
  gate.add(scan, 2);
  const auto scans = gate.take(2);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].scan.first_beam_s, 0.05);
  EXPECT_EQ(scans[0].scan.beam_step_s, -0.001);
  EXPECT_EQ(scans[0].scan.ranges_m, scan.ranges_m);
}

TEST(ScanGate, TimeAndBeamsMustFit) {
  ScanGate gate({.has_base = false});
  gate.open();
  for (const auto& scan : {scan_at(10), scan_at(10), scan_at(9), scan_at(11, 4), scan_at(12)}) {
    gate.add(scan, 12);
  }
  const auto scans = gate.take(12);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[1].scan.stamp_ns, 12);
  EXPECT_EQ(scans[1].scan.sequence, 1U);
  EXPECT_EQ(gate.dropped(ScanDrop::kTime), 2U);
  EXPECT_EQ(gate.dropped(ScanDrop::kGeometry), 1U);
}

/// Range in the middle of a square room of 4 m, by the direction in the room.
float room_range_m(double angle_rad) {
  return static_cast<float>(
      2.0 / std::max(std::fabs(std::cos(angle_rad)), std::fabs(std::sin(angle_rad))));
}

TEST(ScanGate, TheMotionDuringATurnIsTakenOut) {
  // A laser that turns clockwise ten times a second, on a robot that turns by 1 rad/s on the spot.
  constexpr std::size_t kBeams = 360;
  constexpr double kTurn_s = 0.1;
  devices::LaserScan scan = scan_at(200 * kMs, kBeams);
  scan.angle_step_rad = 2.0 * M_PI / kBeams;
  scan.angle_min_rad = 0.5 * scan.angle_step_rad - M_PI;
  scan.time_step_s = -kTurn_s / kBeams;
  scan.first_beam_s = 0.5 * kTurn_s;
  double worst_uncorrected_m = 0.0;
  for (std::size_t i = 0; i < kBeams; ++i) {
    const auto place = static_cast<double>(i);
    const double angle_rad = scan.angle_min_rad + place * scan.angle_step_rad;
    const double heading_rad = 0.2 + scan.first_beam_s + place * scan.time_step_s;
    scan.ranges_m[i] = room_range_m(angle_rad + heading_rad);
    worst_uncorrected_m = std::max<double>(
        worst_uncorrected_m, std::fabs(scan.ranges_m[i] - room_range_m(angle_rad + 0.2)));
  }
  EXPECT_GT(worst_uncorrected_m, 0.09);

  ScanGate gate({.longest_extrapolation_ns = 100 * kMs});
  gate.open();
  for (std::int64_t at_ns = 0; at_ns <= 400 * kMs; at_ns += 50 * kMs) {
    gate.add(
        geometry::OdometrySample{at_ns, {0.0, 0.0, 1e-9 * static_cast<double>(at_ns)}, 0.0, 1.0});
  }
  gate.add(std::move(scan), 400 * kMs);
  const auto scans = gate.take(400 * kMs);
  ASSERT_EQ(scans.size(), 1U);
  const scan::Scan& out = scans[0].scan;
  EXPECT_NEAR(out.T_odom_robot.theta_rad, 0.2, 1e-9);
  for (std::size_t i = 5; i < kBeams - 5; ++i) {
    const double angle_rad = out.angle_min_rad + static_cast<double>(i) * out.angle_step_rad;
    // Two beams beside a corner of the room cut it off.
    EXPECT_NEAR(out.ranges_m[i], room_range_m(angle_rad + 0.2), 0.03) << "beam " << i;
  }
}

TEST(ScanGate, RangesBeyondTheLimitAreNoReturnAsInALog) {
  ScanGate gate({.has_base = false, .range_max_m = 5.0});
  gate.open();
  devices::LaserScan scan = scan_at(1);
  scan.ranges_m = {4.999F, 5.0F, 0.0F};
  gate.add(scan, 1);
  EXPECT_EQ(gate.take(1).at(0).scan.ranges_m, (std::vector<float>{4.999F, 0.0F, 0.0F}));
}

TEST(ScanGate, WithoutWaitingOdometryIsCarriedOn) {
  ScanGate gate({.longest_extrapolation_ns = 500 * kMs});
  gate.open();
  gate.add(scan_at(50 * kMs), 60 * kMs);
  EXPECT_TRUE(gate.take(60 * kMs).empty());
  EXPECT_EQ(gate.dropped(ScanDrop::kNoOdometry), 1U);
  gate.add({100 * kMs, {1.0, 0.0, 0.0}, 1.0, 0.0});
  gate.add(scan_at(150 * kMs), 160 * kMs);
  const auto scans = gate.take(160 * kMs);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_NEAR(scans[0].scan.T_odom_robot.x_m, 1.05, kTolerance);
  EXPECT_EQ(gate.extrapolated(), 1U);
  gate.add(scan_at(601 * kMs), 602 * kMs);  // the base has been silent for too long
  EXPECT_TRUE(gate.take(602 * kMs).empty());
  EXPECT_EQ(gate.dropped(ScanDrop::kNoOdometry), 2U);
}

TEST(ScanGate, OldReadingsOfAMovingRobotAreDropped) {
  ScanGate gate({});
  gate.open();
  const auto published = [&](std::int64_t stamp_ns, std::vector<float> ranges_m,
                             const geometry::Pose2& T_odom_robot) {
    devices::LaserScan scan = scan_at(stamp_ns);
    scan.ranges_m = std::move(ranges_m);
    gate.add({stamp_ns, T_odom_robot});
    gate.add(std::move(scan), stamp_ns);
    return gate.take(stamp_ns).size() == 1;
  };
  EXPECT_TRUE(published(10 * kMs, {1, 2, 3}, {}));
  EXPECT_TRUE(published(20 * kMs, {1, 2, 3}, {}));  // the robot stands
  EXPECT_TRUE(published(30 * kMs, {1, 2, 3}, {0.009, 0, 0}));
  EXPECT_FALSE(published(40 * kMs, {1, 2, 3}, {0.018, 0, 0}));  // by small steps as well
  EXPECT_FALSE(published(50 * kMs, {1, 2, 3}, {0, 0, 0.006}));
  EXPECT_TRUE(published(60 * kMs, {1, 2, 4}, {0.1, 0, 0}));
  EXPECT_TRUE(published(70 * kMs, {0, 0, 0}, {0.1, 0, 0}));
  EXPECT_TRUE(published(80 * kMs, {0, 0, 0}, {0.5, 0, 0}));  // no return at all
  EXPECT_EQ(gate.dropped(ScanDrop::kRepeated), 2U);
}

TEST(ScanGate, WaitsForOdometryAsLongAsItMay) {
  ScanGate gate({.odometry_wait_ns = 100 * kMs, .longest_extrapolation_ns = 500 * kMs});
  gate.open();
  EXPECT_EQ(gate.due_ns(), std::numeric_limits<std::int64_t>::max());
  gate.add({0, {0.0, 0.0, 0.0}, 1.0, 0.0});
  gate.add(scan_at(50 * kMs), 60 * kMs);
  EXPECT_TRUE(gate.take(60 * kMs).empty());
  EXPECT_EQ(gate.due_ns(), 160 * kMs);
  gate.add({100 * kMs, {0.2, 0.0, 0.0}, 1.0, 0.0});  // faster than its reported speed
  ASSERT_EQ(gate.due_ns(), 160 * kMs);
  const auto bracketed = gate.take(101 * kMs);
  ASSERT_EQ(bracketed.size(), 1U);
  EXPECT_EQ(bracketed[0].arrival_ns, 60 * kMs);
  EXPECT_NEAR(bracketed[0].scan.T_odom_robot.x_m, 0.1, kTolerance);
  EXPECT_EQ(gate.extrapolated(), 0U);
  gate.add(scan_at(150 * kMs), 160 * kMs);
  EXPECT_TRUE(gate.take(259 * kMs).empty());
  const auto late = gate.take(260 * kMs);  // no odometry arrived
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].arrival_ns, 160 * kMs);
  EXPECT_NEAR(late[0].scan.T_odom_robot.x_m, 0.25, kTolerance);
  EXPECT_EQ(gate.extrapolated(), 1U);
}

}  // namespace
}  // namespace topogeo::sensor_gateway
