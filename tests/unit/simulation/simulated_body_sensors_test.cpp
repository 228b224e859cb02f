#include "topogeo/simulation/simulated_body_sensors.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/scan/scan.hpp"

namespace topogeo::simulation {
namespace {

using devices::BodyReadings;

// A wall along y at x = 3 m; the robot faces x.
BodyReadings readings_at(double x_m, double sigma_m = 0.0) {
  world::World world;
  world.segments.push_back({{3.0, -20.0}, {3.0, 20.0}});
  BodySensorNoise noise;
  noise.sonar_sigma_m = noise.infrared_sigma_m = sigma_m;
  SimulatedBodySensors sensors([&](std::int64_t) { return world; },
                               [&](std::int64_t) {
                                 return geometry::Pose2{x_m, 0.0, 0.0};
                               },
                               noise);
  const devices::BodySensors& seen = sensors;
  EXPECT_EQ(seen.fault(), "");
  return sensors.read(7).value();
}

TEST(SimulatedBodySensors, SonarsMeasureWhatIsInTheirCones) {
  const BodyReadings readings = readings_at(0.0);
  EXPECT_EQ(readings.stamp_ns, 7);
  ASSERT_EQ(readings.sonar_m.size(), 24U);
  // The edges of the first cones point straight ahead, from beside the foremost point of the body.
  const double half_rad = 7.5 * std::numbers::pi / 180.0;
  EXPECT_NEAR(readings.sonar_m.front(), 3.0 - devices::kB21Radius_m * std::cos(half_rad), 0.006);
  EXPECT_FLOAT_EQ(readings.sonar_m.front(), readings.sonar_m.back());
  EXPECT_EQ(readings.sonar_m[12], scan::Scan::kNoReturn);  // faces backwards
}

TEST(SimulatedBodySensors, InfraredSeesHalfAMetre) {
  EXPECT_EQ(readings_at(2.0).body_infrared_m.front(), scan::Scan::kNoReturn);
  const BodyReadings near = readings_at(2.4);
  ASSERT_EQ(near.body_infrared_m.size(), 24U);
  ASSERT_EQ(near.base_infrared_m.size(), 32U);
  EXPECT_NEAR(near.body_infrared_m.front(), 0.6 - devices::kB21Radius_m, 0.01);
  EXPECT_NEAR(near.base_infrared_m.back(), 0.6 - devices::kB21Radius_m, 0.01);
  EXPECT_EQ(near.base_infrared_m[16], scan::Scan::kNoReturn);
}

TEST(SimulatedBodySensors, PanelsFeelWhatTouchesThem) {
  EXPECT_TRUE(readings_at(2.7).body_pressed.none());
  const BodyReadings touching = readings_at(3.0 - devices::kB21Radius_m - 0.005);
  EXPECT_TRUE(touching.body_pressed[0]);
  EXPECT_TRUE(touching.body_pressed[23]);
  EXPECT_FALSE(touching.body_pressed[12]);
  EXPECT_TRUE(touching.base_pressed[0]);
  EXPECT_TRUE(touching.base_pressed[31]);
  EXPECT_LE(touching.base_pressed.count(), 4U);
}

TEST(SimulatedBodySensors, TakeTheSonarsThatARobotHas) {
  world::World world = world::parse_world("segments: [[2, -5, 2, 5]]", "wall");
  SimulatedBodySensors sensors([&](std::int64_t) { return world; },
                               [](std::int64_t) { return geometry::Pose2{}; },
                               [] {
                                 return std::vector<float>{1.5F, 0.0F};
                               });
  const auto readings = sensors.read(7);
  ASSERT_TRUE(readings);
  EXPECT_EQ(readings->sonar_m, (std::vector<float>{1.5F, 0.0F}));
  EXPECT_EQ(readings->body_infrared_m.size(), 24U);
}

TEST(SimulatedBodySensors, RefuseNoiseOutOfRange) {
  const auto world = [](std::int64_t) { return world::World{}; };
  const auto pose = [](std::int64_t) { return geometry::Pose2{}; };
  BodySensorNoise noise;
  noise.touch_m = -1.0;
  EXPECT_THROW(SimulatedBodySensors(world, pose, noise), std::invalid_argument);
  EXPECT_THROW(SimulatedBodySensors(world, nullptr), std::invalid_argument);
}

TEST(MspBodySensors, SayThatTheyAreNotRead) {
  devices::MspBodySensors sensors;
  EXPECT_FALSE(sensors.read(1));
  EXPECT_NE(sensors.fault(), "");
}

}  // namespace
}  // namespace topogeo::simulation
