// calibrate_odometry on motions with known, simulated noise.
#include "topogeo/calibration/odometry_calibration.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "localization/simulated_motions.hpp"

namespace topogeo::localization {
namespace {

using test::Drive;
using test::kFallback;
using test::kTrue;
using test::Motions;
using test::simulate;

OdometryCalibration calibrate(const Motions& made) {
  OdometryCalibrationConfig config;
  config.fallback = kFallback;
  config.resamples = 40;
  return calibrate_odometry(made.stretches, made.motions, config);
}

double truth(const OdometryNoise& noise, std::size_t parameter) {
  return noise.*kOdometryParameters[parameter].field;
}

TEST(OdometryCalibrationTest, FindsTheNoiseWithinTheSpreadThatItStates) {
  double squared = 0.0;
  int count = 0;
  double scale = 0.0;
  constexpr int kSeeds = 6;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const OdometryCalibration found = calibrate(simulate({}, seed));
    for (std::size_t p = 0; p < kNoiseParameters; ++p) {
      const NoiseEstimate& estimate = found.parameters[p];
      SCOPED_TRACE(std::string(kOdometryParameters[p].key) + ", seed " + std::to_string(seed));
      EXPECT_TRUE(estimate.known);
      const double error = estimate.as_is.value - truth(kTrue, p);
      EXPECT_LT(std::fabs(error), 4.0 * estimate.as_is.spread);
      EXPECT_LT(estimate.as_is.spread, 0.5 * truth(kTrue, p));  // narrow enough to be useful
      if (!estimate.as_is.at_most) {
        squared += error * error / (estimate.as_is.spread * estimate.as_is.spread);
        ++count;
      }
      EXPECT_EQ(truth(found.noise, p), estimate.as_is.value);
    }
    scale += found.measurement_scale / kSeeds;
  }
  EXPECT_NEAR(scale, 1.0, 0.25);  // the odometry's larger noise hides most of it
  // Errors are about as large as the spread.
  EXPECT_GT(squared / count, 0.3);
  EXPECT_LT(squared / count, 2.5);
}

TEST(OdometryCalibrationTest, TwiceTheNoiseGivesTwiceTheEstimates) {
  Drive twice;
  for (const NoiseParameter& parameter : kOdometryParameters) twice.noise.*parameter.field *= 2.0;
  const OdometryCalibration once = calibrate(simulate({}, 3));
  const OdometryCalibration doubled = calibrate(simulate(twice, 3));
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    EXPECT_NEAR(truth(doubled.noise, p) / truth(once.noise, p), 2.0, 0.3)
        << kOdometryParameters[p].key;
  }
}

TEST(OdometryCalibrationTest, EachParameterIsFoundAlone) {
  for (std::size_t loud = 0; loud < kNoiseParameters; ++loud) {
    Drive drive;
    drive.noise = {0.0, 0.0, 0.0, 0.0, 0.0};
    drive.noise.*kOdometryParameters[loud].field = 0.004;
    const OdometryCalibration found = calibrate(simulate(drive, 7));
    for (std::size_t p = 0; p < kNoiseParameters; ++p) {
      SCOPED_TRACE(std::string(kOdometryParameters[loud].key) + " alone, and " +
                   kOdometryParameters[p].key);
      if (p == loud) {
        EXPECT_NEAR(truth(found.noise, p), 0.004, 0.001);
      } else {
        EXPECT_LT(truth(found.noise, p), 0.0004);
        EXPECT_GT(found.parameters[p].as_is.spread, 0.0);
      }
    }
  }
}

TEST(OdometryCalibrationTest, WhatCannotBeToldFromZeroIsGivenAsALimit) {
  Drive drive;
  drive.noise.lateral_m2_per_m = 0.0;
  drive.noise.translation_m2_per_rad = 0.0;
  const OdometryCalibration found = calibrate(simulate(drive, 2));
  const Estimate& lateral = found.parameters[1].as_is;
  EXPECT_TRUE(lateral.at_most);
  EXPECT_GT(lateral.value, lateral.spread);
  EXPECT_GT(lateral.spread, 1e-8);
  EXPECT_LT(lateral.value, 0.0002);
}

TEST(OdometryCalibrationTest, FindsSystematicErrorsAndTakesThemOut) {
  Drive drive;
  drive.too_long = 0.03;
  drive.left_rad_per_m = 0.05;
  drive.turn_too_much = 0.06;
  drive.T_robot_laser = {0.12, -0.03, 0.02};
  const OdometryCalibration found = calibrate(simulate(drive, 5));
  const SystematicErrors& s = found.systematic;
  EXPECT_NEAR(s.distance.value, 0.03, 4.0 * s.distance.spread);
  EXPECT_NEAR(s.heading_rad_per_m.value, 0.05, 4.0 * s.heading_rad_per_m.spread);
  EXPECT_NEAR(s.turn.value, 0.06, 4.0 * s.turn.spread);
  EXPECT_NEAR(s.ahead_m.value, 0.12, 4.0 * s.ahead_m.spread);
  EXPECT_NEAR(s.left_m.value, -0.03, 4.0 * s.left_m.spread);
  EXPECT_NEAR(s.yaw_rad.value, 0.02, 4.0 * s.yaw_rad.spread);
  EXPECT_LT(s.distance.spread, 0.01);
  EXPECT_LT(s.heading_rad_per_m.spread, 0.01);
  EXPECT_LT(s.turn.spread, 0.03);
  EXPECT_LT(s.ahead_m.spread, 0.02);
  EXPECT_LT(s.yaw_rad.spread, 0.01);
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    const Estimate& corrected = found.parameters[p].corrected;
    EXPECT_NEAR(corrected.value, truth(kTrue, p), 4.0 * corrected.spread)
        << kOdometryParameters[p].key;
  }
  // Uncorrected, the drift to the left must be expected as noise of the heading.
  EXPECT_GT(found.noise.heading_rad2_per_m, 3.0 * kTrue.heading_rad2_per_m);
}

TEST(OdometryCalibrationTest, OutlyingMeasurementsAreLeftOut) {
  Drive drive;
  drive.outlying = 0.05;
  const Motions made = simulate(drive, 4);
  const OdometryCalibration found = calibrate(made);
  EXPECT_NEAR(static_cast<double>(found.outlying), 0.05 * static_cast<double>(made.motions.size()),
              15.0);
  EXPECT_EQ(found.motions + found.outlying, made.motions.size());
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    const Estimate& estimate = found.parameters[p].as_is;
    EXPECT_NEAR(estimate.value, truth(kTrue, p), 4.0 * estimate.spread)
        << kOdometryParameters[p].key;
  }
}

TEST(OdometryCalibrationTest, MeasurementsMayStateTooMuchOrTooLittle) {
  for (const double stated_over_true : {0.4, 3.0}) {
    Drive drive;
    drive.stated_over_true = stated_over_true;
    const OdometryCalibration found = calibrate(simulate(drive, 6));
    EXPECT_NEAR(found.measurement_scale * stated_over_true, 1.0, 0.25);
    for (std::size_t p = 0; p < kNoiseParameters; ++p) {
      const Estimate& estimate = found.parameters[p].as_is;
      EXPECT_NEAR(estimate.value, truth(kTrue, p), 4.0 * estimate.spread)
          << kOdometryParameters[p].key << ", " << stated_over_true;
    }
  }
}

TEST(OdometryCalibrationTest, ALogWithoutTurnsSaysNothingOfThem) {
  Drive drive;
  drive.turn_rad = 0.0;
  const OdometryCalibration found = calibrate(simulate(drive, 1));
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    const NoiseEstimate& estimate = found.parameters[p];
    SCOPED_TRACE(kOdometryParameters[p].key);
    EXPECT_EQ(estimate.known, !kOdometryParameters[p].per_turn);
    if (estimate.known) {
      EXPECT_NEAR(estimate.as_is.value, truth(kTrue, p), 4.0 * estimate.as_is.spread);
    } else {
      EXPECT_EQ(estimate.stretches, 0U);
      EXPECT_EQ(estimate.as_is.value, truth(kFallback, p));
      EXPECT_EQ(truth(found.noise, p), truth(kFallback, p));
    }
  }
  EXPECT_EQ(found.systematic.turn.value, 0.0);
}

TEST(OdometryCalibrationTest, ALogOfTurnsOnTheSpotSaysNothingOfTheWay) {
  Drive drive;
  drive.path_m = 0.0;
  const OdometryCalibration found = calibrate(simulate(drive, 1));
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    EXPECT_EQ(found.parameters[p].known, kOdometryParameters[p].per_turn);
  }
  EXPECT_EQ(found.noise.heading_rad2_per_m, kFallback.heading_rad2_per_m);
  const Estimate& heading = found.parameters[4].as_is;
  EXPECT_NEAR(heading.value, kTrue.heading_rad2_per_rad, 4.0 * heading.spread);
}

TEST(OdometryCalibrationTest, RepeatsToTheLastBit) {
  const Motions made = simulate({}, 9);
  const OdometryCalibration a = calibrate(made);
  const OdometryCalibration b = calibrate(made);
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    EXPECT_EQ(a.parameters[p].as_is.value, b.parameters[p].as_is.value);
    EXPECT_EQ(a.parameters[p].as_is.spread, b.parameters[p].as_is.spread);
  }
}

TEST(OdometryCalibrationTest, TellsItsProgress) {
  const Motions made = simulate({}, 9);
  OdometryCalibrationConfig config;
  config.resamples = 5;
  std::vector<std::size_t> heard;
  calibrate_odometry(made.stretches, made.motions, config,
                     [&](std::size_t done, std::size_t total) {
                       EXPECT_EQ(total, 10U);
                       heard.push_back(done);
                     });
  EXPECT_EQ(heard.size(), 10U);
  EXPECT_EQ(heard.back(), 10U);
}

TEST(OdometryCalibrationTest, TooLittleMotionIsToldWithNumbers) {
  Drive drive;
  drive.stops = 15;
  const Motions few = simulate(drive, 1);
  try {
    calibrate(few);
    FAIL() << "expected an error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("14 measured stretches"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("at least 20"), std::string::npos) << error.what();
  }
  drive = {};
  drive.path_m = 0.0;
  drive.turn_rad = 0.0;
  EXPECT_THROW(calibrate(simulate(drive, 1)), std::runtime_error);
  EXPECT_THROW(calibrate({}), std::runtime_error);
}

TEST(OdometryCalibrationTest, RefusesMotionsThatAreNone) {
  const Motions good = simulate({}, 1);
  const auto spoiled = [&](const auto& spoil) {
    Motions made = good;
    spoil(made.motions[5]);
    return made;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using M = MeasuredMotion;
  EXPECT_THROW(calibrate(spoiled([](M& m) { m.last = m.first; })), std::invalid_argument);
  EXPECT_THROW(calibrate(spoiled([](M& m) { m.last = 300; })), std::invalid_argument);
  EXPECT_THROW(calibrate(spoiled([&](M& m) { m.T_first_last.y_m = nan; })), std::invalid_argument);
  EXPECT_THROW(calibrate(spoiled([](M& m) { m.covariance(1, 1) = -1.0; })), std::invalid_argument);
  EXPECT_THROW(calibrate(spoiled([&](M& m) { m.covariance(0, 0) = nan; })), std::invalid_argument);
  OdometryCalibrationConfig config;
  config.blocks = 3;
  EXPECT_THROW(calibrate_odometry(good.stretches, good.motions, config), std::invalid_argument);
  config.blocks = 20;
  config.resamples = 1;
  EXPECT_THROW(calibrate_odometry(good.stretches, good.motions, config), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
