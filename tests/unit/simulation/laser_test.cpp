#include "topogeo/simulation/laser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "topogeo/scan/scan.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

world::World box_6x4() {
  return world::parse_world("boxes: [{from: [0, 0], to: [6, 4]}]", "box");
}

// Distance from inside the box to its border: the nearer of the two sides ahead of the beam.
double box_oracle(double x, double y, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double to_x = c > 0.0 ? (6.0 - x) / c : (c < 0.0 ? -x / c : kInfinity);
  const double to_y = s > 0.0 ? (4.0 - y) / s : (s < 0.0 ? -y / s : kInfinity);
  return std::min(to_x, to_y);
}

TEST(Raycast, AgreesWithTheAnalyticBox) {
  const world::World world = box_6x4();
  const BeamPattern beams;
  for (const double x : {0.3, 2.0, 5.9}) {
    for (const double y : {0.1, 2.0, 3.5}) {
      for (const double theta : {-3.0, -1.0, 0.0, 0.7, 2.5}) {
        const auto ranges_m = raycast(world, {x, y, theta}, beams);
        ASSERT_EQ(ranges_m.size(), 361U);
        for (std::size_t i = 0; i < ranges_m.size(); ++i) {
          const double angle = theta - kPi / 2.0 + static_cast<double>(i) * kPi / 360.0;
          ASSERT_NEAR(ranges_m[i], box_oracle(x, y, angle), 1e-9) << x << " " << y << " " << i;
        }
      }
    }
  }
}

TEST(Raycast, AgreesWithTheAnalyticBoxAllRoundAndMoreThanOnce) {
  const world::World world = box_6x4();
  // One and a half turns, from an angle that is no multiple of the step.
  const BeamPattern beams{.angle_min_rad = -4.4, .angle_step_rad = 0.0137, .count = 688};
  for (double theta = -3.1; theta < 3.1; theta += 0.37) {
    const auto ranges_m = raycast(world, {4.9, 0.2, theta}, beams);
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const double angle = theta - 4.4 + static_cast<double>(i) * 0.0137;
      ASSERT_NEAR(ranges_m[i], box_oracle(4.9, 0.2, angle), 1e-9) << theta << " " << i;
    }
  }
}

TEST(Raycast, SeesTheNearSideOfAColumn) {
  const world::World world = world::parse_world("columns: [{center: [3, 0], radius: 0.5}]", "w");
  // Straight ahead, past the edge of the column (asin(0.5 / 3) = 9.59 degrees), and from inside.
  const BeamPattern ahead{.angle_min_rad = 0.0, .angle_step_rad = kPi / 180.0, .count = 11};
  const auto ranges_m = raycast(world, {0.0, 0.0, 0.0}, ahead);
  EXPECT_NEAR(ranges_m[0], 2.5, 1e-12);
  const double s = 3.0 * std::sin(5.0 * kPi / 180.0);
  EXPECT_NEAR(ranges_m[5], 3.0 * std::cos(5.0 * kPi / 180.0) - std::sqrt(0.25 - s * s), 1e-12);
  EXPECT_TRUE(std::isfinite(ranges_m[9]));
  EXPECT_EQ(ranges_m[10], kInfinity);
  EXPECT_NEAR(raycast(world, {3.0, 0.0, 0.0}, ahead)[0], 0.5, 1e-12);
}

TEST(Raycast, NothingBehindOrBeyondTheMaximumIsSeen) {
  const world::World world =
      world::parse_world("segments: [[-5, -1, -5, 1], [20, -1, 20, 1]]", "w");
  const BeamPattern one{
      .angle_min_rad = 0.0, .angle_step_rad = 1.0, .count = 1, .range_max_m = 20.0};
  EXPECT_EQ(raycast(world, {0.0, 0.0, 0.0}, one)[0], kInfinity);
  EXPECT_NEAR(raycast(world, {0.5, 0.0, 0.0}, one)[0], 19.5, 1e-12);
}

TEST(Raycast, TheNearestOfSeveralSurfacesCounts) {
  const world::World world = world::parse_world(
      "segments: [[9, -1, 9, 1], [4, -1, 4, 1]]\ncolumns: [{center: [7, 0], radius: 1}]", "w");
  const BeamPattern one{.angle_min_rad = 0.0, .angle_step_rad = 1.0, .count = 1};
  EXPECT_NEAR(raycast(world, {0.0, 0.0, 0.0}, one)[0], 4.0, 1e-12);
  EXPECT_NEAR(raycast(world, {5.0, 0.0, 0.0}, one)[0], 1.0, 1e-12);
}

TEST(LaserNoise, HasTheStatisticsOfThePls) {
  constexpr std::size_t kCount = 100'000;
  const double range_m = 3.1234;
  support::Random random(5);
  const auto readings_m = measure(std::vector<double>(kCount, range_m), {}, random);
  double sum = 0.0;
  double sum2 = 0.0;
  std::size_t dropped = 0;
  for (const float reading_m : readings_m) {
    if (reading_m == scan::Scan::kNoReturn) {
      ++dropped;
      continue;
    }
    const double error = static_cast<double>(reading_m) - range_m;
    ASSERT_LE(std::fabs(error), 0.05 + 0.005 + 1e-6);
    const double cm = static_cast<double>(reading_m) * 100.0;
    ASSERT_NEAR(cm, std::round(cm), 1e-4);
    sum += error;
    sum2 += error * error;
  }
  const double n = static_cast<double>(kCount - dropped);
  EXPECT_NEAR(static_cast<double>(dropped) / kCount, 0.002, 0.0006);
  EXPECT_NEAR(sum / n, 0.0, 0.0004);
  // Normal of 2 cm cut at 2.5 sigma has 1.91 cm; rounding to 1 cm adds 0.29 cm: 1.93 cm.
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.0193, 0.0003);
}

TEST(LaserNoise, CanBeSwitchedOff) {
  support::Random random(5);
  const LaserNoise none{
      .sigma_m = 0.0, .bound_m = 0.0, .resolution_m = 0.0, .dropout_probability = 0.0};
  const auto readings_m = measure({1.23456, kInfinity}, none, random);
  EXPECT_EQ(readings_m[0], 1.23456F);
  EXPECT_EQ(readings_m[1], scan::Scan::kNoReturn);
  const LaserNoise all_lost{.dropout_probability = 1.0};
  EXPECT_EQ(measure({1.0}, all_lost, random)[0], scan::Scan::kNoReturn);
}

}  // namespace
}  // namespace topogeo::simulation
