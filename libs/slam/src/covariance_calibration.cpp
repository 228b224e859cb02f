#include "covariance_calibration.hpp"

#include <algorithm>

#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {

namespace {

// Share of the variances beyond the floor, fitted to the triangles of recorded logs with each log
// left out once (docs/decisions/loop_probability.md).
constexpr double kUsualShare = 0.06;
// Factor on the variance for the common part of errors along a path, which no triangle shows.
constexpr double kCommonErrors = 1.5;
constexpr double kFloor_m = 0.002;
constexpr double kFloor_rad = 0.0005;
// A larger triangle contains a wrong match, which carries no information about the others.
constexpr double kLargestSquare = 30.0;
constexpr double kLeastOfTriangles = 0.3;
constexpr double kMostOfTriangles = 6.0;

Eigen::Matrix3d usual(const Eigen::Matrix3d& covariance, double factor) {
  Eigen::Matrix3d c = kUsualShare * factor * (covariance - match_covariance_floor());
  c(0, 0) += kFloor_m * kFloor_m;
  c(1, 1) += kFloor_m * kFloor_m;
  c(2, 2) += kFloor_rad * kFloor_rad;
  return c;
}

}  // namespace

Eigen::Matrix3d map_noise() {
  constexpr double kNoise_m = 0.1;
  constexpr double kNoise_rad = 0.015;
  return Eigen::Vector3d(kNoise_m * kNoise_m, kNoise_m * kNoise_m, kNoise_rad * kNoise_rad)
      .asDiagonal();
}

void CovarianceCalibration::add_triangle(const UncertainPose& direct, const UncertainPose& first,
                                         const UncertainPose& second) {
  const UncertainPose around = compose({first.T_a_b, usual(first.covariance, 1.0)},
                                       {second.T_a_b, usual(second.covariance, 1.0)});
  const double square =
      geometry::squared_mahalanobis(geometry::difference(around.T_a_b, direct.T_a_b),
                                    around.covariance + usual(direct.covariance, 1.0));
  if (!(square <= kLargestSquare)) return;
  sum_ += square / 3.0;
  weight_ += 1.0;
}

double CovarianceCalibration::factor() const {
  return std::clamp(sum_ / weight_, kLeastOfTriangles, kMostOfTriangles);
}

Eigen::Matrix3d CovarianceCalibration::of_match(const Eigen::Matrix3d& covariance) const {
  return usual(covariance, kCommonErrors * factor());
}

}  // namespace topogeo::localization
