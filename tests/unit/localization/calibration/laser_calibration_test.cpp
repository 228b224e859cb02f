// calibrate_laser on motions of a robot and of a laser with a known mounting.
#include "topogeo/calibration/laser_calibration.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "localization/simulated_motions.hpp"

namespace topogeo::localization {
namespace {

using test::Drive;
using test::kTrue;
using test::Motions;
using test::Pose2;

/// Ten times smaller than kTrue: the noise of a good robot.
OdometryNoise small_noise() {
  OdometryNoise noise = kTrue;
  for (const NoiseParameter& parameter : kOdometryParameters) noise.*parameter.field *= 0.1;
  return noise;
}

LaserCalibration calibrate_mounting(const Drive& drive, const Motions& made) {
  OdometryCalibrationConfig config;
  config.resamples = 30;
  return calibrate_laser(made.stretches, made.motions, drive.T_robot_assumed, config);
}

LaserCalibration calibrate_mounting(const Drive& drive, std::uint64_t seed) {
  return calibrate_mounting(drive, test::simulate(drive, seed));
}

// Mountings of lasers: in front, in a corner and turned, facing sideways, facing backwards.
const std::vector<Pose2> kMountings = {
    {0.1, 0.0, 0.0}, {0.31, -0.12, 0.2}, {0.05, 0.2, std::numbers::pi / 2}, {-0.25, 0.03, 3.0}};

TEST(LaserCalibrationTest, ExactMotionsGiveTheExactMounting) {
  for (const Pose2& mounting : kMountings) {
    Drive drive;
    drive.noise = {0.0, 0.0, 0.0, 0.0, 0.0};
    drive.exact = true;
    drive.stops = 60;
    drive.T_robot_laser = mounting;
    drive.T_robot_assumed = {mounting.x_m - 0.1, mounting.y_m + 0.05, mounting.theta_rad - 0.1};
    const LaserCalibration found = calibrate_mounting(drive, 1);
    SCOPED_TRACE(mounting.theta_rad);
    EXPECT_TRUE(found.x_m.known && found.y_m.known && found.yaw_rad.known);
    EXPECT_NEAR(found.x_m.value, mounting.x_m, 1e-6);
    EXPECT_NEAR(found.y_m.value, mounting.y_m, 1e-6);
    EXPECT_NEAR(geometry::wrap_angle(found.yaw_rad.value - mounting.theta_rad), 0.0, 1e-6);
    EXPECT_EQ(found.outlying, 0U);
  }
}

TEST(LaserCalibrationTest, NoisyMotionsGiveItWithinTheSpreadThatIsStated) {
  double squared = 0.0;
  int count = 0;
  for (std::size_t m = 0; m < kMountings.size(); ++m) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      Drive drive;
      drive.noise = small_noise();
      drive.outlying = 0.03;
      drive.too_long = 0.02;
      drive.left_rad_per_m = 0.02;
      drive.T_robot_laser = kMountings[m];
      drive.T_robot_assumed = kMountings[m] * Pose2{-0.1, 0.05, -0.1};
      const LaserCalibration found = calibrate_mounting(drive, 10 * m + seed);
      SCOPED_TRACE("mounting " + std::to_string(m) + ", seed " + std::to_string(seed));
      const auto expect = [&](const MountingEstimate& part, double truth, double largest) {
        const double error = geometry::wrap_angle(part.value - truth);
        EXPECT_TRUE(part.known);
        EXPECT_LT(std::fabs(error), 4.0 * part.spread);
        EXPECT_LT(part.spread, largest);  // narrow enough to be useful
        squared += error * error / (part.spread * part.spread);
        ++count;
      };
      expect(found.x_m, kMountings[m].x_m, 0.01);
      expect(found.y_m, kMountings[m].y_m, 0.01);
      expect(found.yaw_rad, kMountings[m].theta_rad, 0.01);
      EXPECT_GT(found.outlying, 0U);
    }
  }
  EXPECT_LT(squared / count, 2.5);
  EXPECT_GT(squared / count, 0.2);
}

TEST(LaserCalibrationTest, WithoutTurnsOnlyTheYawIsKnown) {
  Drive drive;
  drive.noise = small_noise();
  drive.turn_rad = 0.0;
  drive.T_robot_laser = {0.2, 0.1, 0.1};
  drive.T_robot_assumed = {0.05, 0.0, 0.0};
  const LaserCalibration found = calibrate_mounting(drive, 3);
  EXPECT_FALSE(found.x_m.known);
  EXPECT_FALSE(found.y_m.known);
  EXPECT_EQ(found.x_m.value, 0.05);  // unchanged
  EXPECT_EQ(found.y_m.value, 0.0);
  EXPECT_EQ(found.with_turn, 0U);
  EXPECT_TRUE(found.yaw_rad.known);
  EXPECT_NEAR(found.yaw_rad.value, 0.1, 4.0 * found.yaw_rad.spread);
  EXPECT_EQ(found.T_robot_laser(), (Pose2{0.05, 0.0, found.yaw_rad.value}));
}

TEST(LaserCalibrationTest, OnTheSpotOnlyThePositionIsKnown) {
  Drive drive;
  drive.noise = small_noise();
  drive.path_m = 0.0;
  drive.T_robot_laser = {0.2, 0.1, 0.1};
  const LaserCalibration found = calibrate_mounting(drive, 4);
  EXPECT_FALSE(found.yaw_rad.known);
  EXPECT_EQ(found.yaw_rad.value, 0.0);
  EXPECT_EQ(found.with_path, 0U);
  // Only the centre of rotation relative to the laser is known: if the laser is assumed to face
  // forward, that is (0.2, 0.1) turned back by the yaw.
  const Eigen::Vector2d place = Pose2{0.0, 0.0, -0.1} * Eigen::Vector2d(0.2, 0.1);
  EXPECT_TRUE(found.x_m.known && found.y_m.known);
  EXPECT_NEAR(found.x_m.value, place.x(), 4.0 * found.x_m.spread);
  EXPECT_NEAR(found.y_m.value, place.y(), 4.0 * found.y_m.spread);
}

TEST(LaserCalibrationTest, NoisyOdometryLeavesAPartOpenInsteadOfGivingANumber) {
  Drive drive;
  drive.noise.translation_m2_per_rad = 0.5;  // 0.7 m for each radian of turn
  drive.stops = 80;
  drive.T_robot_laser = {0.1, 0.0, 0.0};
  const LaserCalibration found = calibrate_mounting(drive, 5);
  EXPECT_FALSE(found.x_m.known);
  EXPECT_GT(found.x_m.spread, kLargestMountingSpread_m);
  EXPECT_EQ(found.x_m.value, 0.0);
}

TEST(LaserCalibrationTest, RepeatsToTheLastBitAndRefusesTooLittle) {
  Drive drive;
  drive.T_robot_laser = {0.1, 0.0, 0.0};
  const Motions made = test::simulate(drive, 9);
  EXPECT_EQ(calibrate_mounting(drive, made).T_robot_laser(),
            calibrate_mounting(drive, made).T_robot_laser());
  drive.stops = 10;
  EXPECT_THROW((void)calibrate_mounting(drive, 1), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::localization
