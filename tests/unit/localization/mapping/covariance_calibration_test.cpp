// Matches with errors of a known size, and the calibration from triangles of them.
#include "covariance_calibration.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// A covariance of match_covariance: its floor plus five times as much.
Eigen::Matrix3d stated() {
  return 6.0 * match_covariance_floor();
}

/// Triangles of matches with errors of so many calibrated deviations.
CovarianceCalibration after(int triangles, double deviations) {
  support::Random random(5);
  const Eigen::Matrix3d usual = CovarianceCalibration().of_match(stated());
  const auto measured = [&](const Pose2& truth) {
    return UncertainPose{{truth.x_m + deviations * std::sqrt(usual(0, 0)) * random.normal(),
                          truth.y_m + deviations * std::sqrt(usual(1, 1)) * random.normal(),
                          truth.theta_rad + deviations * std::sqrt(usual(2, 2)) * random.normal()},
                         stated()};
  };
  CovarianceCalibration calibration;
  const Pose2 first{1.0, 0.2, 0.3};
  const Pose2 second{0.8, -0.1, -0.2};
  for (int i = 0; i < triangles; ++i) {
    calibration.add_triangle(measured(first * second), measured(first), measured(second));
  }
  return calibration;
}

TEST(CovarianceCalibrationTest, StartsAsUsual) {
  const CovarianceCalibration calibration;
  EXPECT_EQ(calibration.factor(), 1.0);
  const Eigen::Matrix3d calibrated = calibration.of_match(stated());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(calibrated).eigenvalues().minCoeff(),
            0.0);
  EXPECT_LT(calibrated(0, 0), stated()(0, 0));
  EXPECT_LT(calibrated(2, 2), stated()(2, 2));
}

TEST(CovarianceCalibrationTest, LearnsThatErrorsAreLargerOrSmaller) {
  EXPECT_LT(after(400, 0.3).factor(), 0.5);
  EXPECT_GT(after(400, 2.0).factor(), 2.0);
  EXPECT_LT(after(400, 0.3).of_match(stated())(0, 0), after(400, 2.0).of_match(stated())(0, 0));
}

TEST(CovarianceCalibrationTest, AWrongMatchSaysNothingOfTheOthers) {
  CovarianceCalibration calibration;
  const UncertainPose step{{1.0, 0.0, 0.0}, stated()};
  for (int i = 0; i < 50; ++i) calibration.add_triangle({{3.0, 1.0, 0.0}, stated()}, step, step);
  EXPECT_EQ(calibration.factor(), 1.0);
}

TEST(CovarianceCalibrationTest, StaysWithinReason) {
  EXPECT_GE(after(4000, 0.0).factor(), 0.3);
  EXPECT_LE(after(4000, 2.5).factor(), 6.0);
}

}  // namespace
}  // namespace topogeo::localization
