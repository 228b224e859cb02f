// The likelihood behind calibrate_odometry and its maximum.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/calibration/odometry_calibration.hpp"

namespace topogeo::localization {

/// Smallest value of a parameter: the lower end of its range in the configuration.
inline constexpr double kSmallestNoise = kSmallestOdometryNoise;

inline constexpr int kSystematicErrors = 6;
using SystematicVector = Eigen::Matrix<double, kSystematicErrors, 1>;

/// A motion as the likelihood uses it.
struct MotionTerms {
  Eigen::Vector3d residual;  ///< odometry minus measurement
  Eigen::Matrix<double, 3, kSystematicErrors>
      systematic;  ///< derivative of the residual by distance, heading per metre, turn, ahead,
                   ///< left, yaw
  std::array<Eigen::Matrix3d, kNoiseParameters> growth;  ///< covariance per unit of each parameter
  Eigen::Matrix3d measurement;                           ///< covariance
};

/// Parameters of the model that are estimated; the others are zero.
struct FitModel {
  std::array<bool, kNoiseParameters> noise{};
  std::array<bool, kSystematicErrors> systematic{};
};

struct NoiseFit {
  std::array<double, kNoiseParameters> noise{};  ///< in the order of kOdometryParameters
  double measurement_factor = 1.0;               ///< of the covariances of the measurements
  SystematicVector systematic = SystematicVector::Zero();
};

/// Linearised about the parameters of `about`. Headings that are wrong by some degrees bend the
/// path, which shortens it on average.
MotionTerms make_terms(std::span<const OdometryStretch> stretches, const MeasuredMotion& motion,
                       const NoiseFit& about);

/// The most likely parameters of the motions, each counted `weights` times, from a start near them.
NoiseFit fit_noise(const FitModel& model, std::span<const MotionTerms> motions,
                   std::span<const double> weights, const NoiseFit& start);

/// Like fit_noise, but robust: sets the weights of motions beyond the limit to 0.
NoiseFit fit_robustly(const FitModel& model, std::span<const MotionTerms> motions,
                      double largest_mahalanobis2, const NoiseFit& start,
                      std::vector<double>& weights);

/// Covariance of the systematic errors of a fit for known noise. Errors that are not in the model,
/// or to which no motion contributes, have the variance 1.
Eigen::Matrix<double, kSystematicErrors, kSystematicErrors> systematic_covariance(
    const FitModel& model, std::span<const MotionTerms> motions, std::span<const double> weights,
    const NoiseFit& fit);

/// How much a parameter may exceed its value in `fit` until the data, counted as
/// `independent_motions`, contradict it as much as one standard deviation does.
double upper_width(const FitModel& model, std::span<const MotionTerms> motions,
                   std::span<const double> weights, const NoiseFit& fit, std::size_t parameter,
                   double independent_motions);

}  // namespace topogeo::localization
