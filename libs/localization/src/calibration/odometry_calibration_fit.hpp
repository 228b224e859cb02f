// The likelihood behind calibrate_odometry and its maximum.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/calibration/odometry_calibration.hpp"

namespace topogeo::localization {

/// Smallest value of a parameter: the lower end of its range in the configuration.
inline constexpr double kSmallestNoise = kSmallestOdometryNoise;

inline constexpr int kSystematicErrors = 6;
using SystematicVector = Eigen::Matrix<double, kSystematicErrors, 1>;

/// A motion in the form that the likelihood wants.
struct MotionTerms {
  Eigen::Vector3d residual;  ///< odometry less measurement
  Eigen::Matrix<double, 3, kSystematicErrors>
      systematic;  ///< derivative of the residual by distance, heading per metre, turn, ahead,
                   ///< left, yaw
  std::array<Eigen::Matrix3d, kNoiseParameters> growth;  ///< covariance for each parameter at 1
  Eigen::Matrix3d measurement;                           ///< covariance
};

/// What of the model is estimated; the rest is zero.
struct FitModel {
  std::array<bool, kNoiseParameters> noise{};
  std::array<bool, kSystematicErrors> systematic{};
};

struct NoiseFit {
  std::array<double, kNoiseParameters> noise{};  ///< in the order of kOdometryParameters
  double measurement_factor = 1.0;               ///< of the covariances of the measurements
  SystematicVector systematic = SystematicVector::Zero();
};

/// Linear in the parameters about those of `about`: headings that are wrong by some degrees bend
/// the path, which shortens it on average.
MotionTerms make_terms(std::span<const OdometryStretch> stretches, const MeasuredMotion& motion,
                       const NoiseFit& about);

/// The most likely parameters of the motions, each counted `weights` times, from a start near them.
NoiseFit fit_noise(const FitModel& model, std::span<const MotionTerms> motions,
                   std::span<const double> weights, const NoiseFit& start);

/// The same against outlying motions: sets the weights of those beyond the limit to 0.
NoiseFit fit_robustly(const FitModel& model, std::span<const MotionTerms> motions,
                      double largest_mahalanobis2, const NoiseFit& start,
                      std::vector<double>& weights);

/// Covariance of the systematic errors of a fit, the noise being known. What the model has not or
/// no motion bears on has the variance 1.
Eigen::Matrix<double, kSystematicErrors, kSystematicErrors> systematic_covariance(
    const FitModel& model, std::span<const MotionTerms> motions, std::span<const double> weights,
    const NoiseFit& fit);

/// How much larger than in `fit` a parameter may be before the data, counted as
/// `independent_motions`, speak against it as they do against one standard deviation.
double upper_width(const FitModel& model, std::span<const MotionTerms> motions,
                   std::span<const double> weights, const NoiseFit& fit, std::size_t parameter,
                   double independent_motions);

}  // namespace topogeo::localization
