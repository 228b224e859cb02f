// Scans whose stamps are later or earlier than those of odometry.
#include "topogeo/calibration/scan_delay.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

constexpr double kPeriod_s = 8.0;
constexpr double kTurning_s = 2.0;  // of each period
constexpr double kTurn_rad_s = 0.7;

/// Heading of a robot that turns to the left for some seconds of each period, and drives straight
/// on for the others.
double heading_rad(double time_s) {
  const double periods = std::floor(time_s / kPeriod_s);
  const double turning_s = std::fmin(time_s - periods * kPeriod_s, kTurning_s);
  return kTurn_rad_s * (periods * kTurning_s + turning_s);
}

double seconds(std::int64_t time_ns) {
  return 1e-9 * static_cast<double>(time_ns);
}

std::optional<double> turn_rad(std::int64_t first_ns, std::int64_t last_ns) {
  return geometry::wrap_angle(heading_rad(seconds(last_ns)) - heading_rad(seconds(first_ns)));
}

/// Motions of 0.9 s with stamps that are late by `delay_s`; `side` -1: seen mirrored.
std::vector<LaserMotion> motions(double delay_s, double side = 1.0) {
  std::vector<LaserMotion> found;
  for (int i = 0; i < 100; ++i) {
    const double first_s = 20.0 + 0.9 * i;
    LaserMotion motion;
    motion.T_laser.theta_rad = side * (heading_rad(first_s + 0.9) - heading_rad(first_s));
    motion.first_ns = std::llround(1e9 * (first_s + delay_s));
    motion.last_ns = std::llround(1e9 * (first_s + 0.9 + delay_s));
    found.push_back(motion);
  }
  return found;
}

TEST(ScanDelayTest, FindsLateAndEarlyStamps) {
  for (const double delay_s : {0.25, -0.3}) {
    const auto found = find_scan_delay(motions(delay_s), turn_rad, false);
    ASSERT_TRUE(found) << delay_s;
    EXPECT_NEAR(found->delay_s, delay_s, 0.011);
    EXPECT_GE(found->votes.for_it, 10U);
    EXPECT_EQ(found->votes.against, 0U);
  }
}

TEST(ScanDelayTest, FindsThemOfALaserUpsideDown) {
  ASSERT_TRUE(find_scan_delay(motions(0.2, -1.0), turn_rad, true));
  EXPECT_NEAR(find_scan_delay(motions(0.2, -1.0), turn_rad, true)->delay_s, 0.2, 0.011);
}

TEST(ScanDelayTest, LeavesSmallAndUnclearOnes) {
  EXPECT_FALSE(find_scan_delay(motions(0.0), turn_rad, false));
  EXPECT_FALSE(find_scan_delay(motions(0.05), turn_rad, false));
  EXPECT_FALSE(find_scan_delay(motions(2.0), turn_rad, false)) << "beyond what is searched";
  EXPECT_FALSE(find_scan_delay({}, turn_rad, false));
  const auto straight = [](std::int64_t, std::int64_t) { return std::optional(0.0); };
  EXPECT_FALSE(find_scan_delay(motions(0.25), straight, false));
  const auto unknown = [](std::int64_t, std::int64_t) { return std::optional<double>(); };
  EXPECT_FALSE(find_scan_delay(motions(0.25), unknown, false));
}

}  // namespace
}  // namespace topogeo::localization
