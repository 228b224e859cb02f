#include "topogeo/calibration/odometry_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "topogeo/support/config_schema.hpp"
#include "topogeo/support/random.hpp"

#include "odometry_calibration_fit.hpp"

namespace topogeo::localization {

const std::array<NoiseParameter, kNoiseParameters> kOdometryParameters{{
    {"translation_m2_per_m", "m2/m", &OdometryNoise::translation_m2_per_m, false},
    {"lateral_m2_per_m", "m2/m", &OdometryNoise::lateral_m2_per_m, false},
    {"translation_m2_per_rad", "m2/rad", &OdometryNoise::translation_m2_per_rad, true},
    {"heading_rad2_per_m", "rad2/m", &OdometryNoise::heading_rad2_per_m, false},
    {"heading_rad2_per_rad", "rad2/rad", &OdometryNoise::heading_rad2_per_rad, true},
}};

namespace {

// Fixed: a shorter stretch shows only the noise of the measurement.
constexpr double kLeastPath_m = 0.2;
constexpr double kLeastTurn_rad = 0.2;
constexpr double kLargestNoise = kLargestOdometryNoise;

void check_measurements(std::span<const OdometryStretch> stretches,
                        std::span<const MeasuredMotion> motions,
                        const OdometryCalibrationConfig& config) {
  support::check_ranges(config);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const MeasuredMotion& motion = motions[i];
    const std::string name = "calibrate_odometry: motion " + std::to_string(i);
    if (motion.first >= motion.last || motion.last > stretches.size()) {
      throw std::invalid_argument(name + " leads from stop " + std::to_string(motion.first) +
                                  " to " + std::to_string(motion.last) +
                                  ", expected ascending stops below " +
                                  std::to_string(stretches.size() + 1));
    }
    if (!geometry::difference(motion.T_first_last, {}).allFinite() ||
        !motion.covariance.allFinite() || motion.covariance.llt().info() != Eigen::Success) {
      throw std::invalid_argument(
          name + ": the pose is not finite or its covariance not positive definite");
    }
  }
}

/// Number of stretches covered by motions, and how many of them have enough distance or turn.
struct Coverage {
  std::size_t stretches = 0;
  std::size_t with_path = 0;
  std::size_t with_turn = 0;
};

Coverage coverage(std::span<const OdometryStretch> stretches,
                  std::span<const MeasuredMotion> motions) {
  std::vector<bool> covered(stretches.size(), false);
  for (const MeasuredMotion& motion : motions) {
    std::fill(covered.begin() + motion.first, covered.begin() + motion.last, true);
  }
  Coverage count;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (!covered[i]) continue;
    double path_m = 0.0;
    double turn_rad = 0.0;
    for (const geometry::Pose2& step : stretches[i]) {
      path_m += std::sqrt(step.position_m().squaredNorm());
      turn_rad += std::fabs(step.theta_rad);
    }
    ++count.stretches;
    if (path_m >= kLeastPath_m) ++count.with_path;
    if (turn_rad >= kLeastTurn_rad) ++count.with_turn;
  }
  return count;
}

/// Fits to all motions and to resamples of blocks of the log.
struct Fits {
  NoiseFit best;
  std::vector<NoiseFit> resampled;
  std::vector<MotionTerms> terms;  // about the best fit
  std::vector<double> weights;     // of the best fit; 0: outlying
};

template <typename Value>
Estimate estimate(const Fits& fits, const Value& value) {
  double sum = 0.0;
  for (const NoiseFit& fit : fits.resampled) sum += value(fit);
  const auto count = static_cast<double>(fits.resampled.size());
  const double mean = sum / count;
  double squared = 0.0;
  for (const NoiseFit& fit : fits.resampled) {
    squared += (value(fit) - mean) * (value(fit) - mean);
  }
  return {value(fits.best), std::sqrt(squared / std::max(1.0, count - 1.0))};
}

class Bootstrap {
 public:
  Bootstrap(std::span<const OdometryStretch> stretches, std::span<const MeasuredMotion> motions,
            const OdometryCalibrationConfig& config)
      : config_(config),
        stretches_(stretches),
        motions_(motions),
        blocks_(std::min<std::size_t>(config.blocks, stretches.size())) {}

  [[nodiscard]] Estimate noise(const FitModel& model, const Fits& fits, std::size_t parameter,
                               double independent_motions) const {
    Estimate found = estimate(fits, [parameter](const NoiseFit& fit) {
      return std::min(fit.noise[parameter], kLargestNoise);
    });
    // At the lower limit all resamples agree, but that is no certainty.
    const bool at_border = found.value <= 2.0 * kSmallestNoise;
    if (at_border) {
      found.spread = std::max(found.spread, upper_width(model, fits.terms, fits.weights, fits.best,
                                                        parameter, independent_motions));
    }
    found.at_most = at_border || found.value < found.spread;
    if (found.at_most) found.value = std::min(found.value + found.spread, kLargestNoise);
    return found;
  }

  [[nodiscard]] Fits run(const FitModel& model, const std::function<void()>& step) const {
    NoiseFit start;
    for (std::size_t p = 0; p < kNoiseParameters; ++p) {
      start.noise[p] = std::max(config_.fallback.*kOdometryParameters[p].field, 1e-4);
    }
    Fits fits;
    constexpr int kLinearizations = 3;  // enough for errors of some percent
    for (int i = 0; i < kLinearizations; ++i) {
      const NoiseFit about = i == 0 ? NoiseFit{} : fits.best;
      fits.terms.clear();
      for (const MeasuredMotion& motion : motions_) {
        fits.terms.push_back(make_terms(stretches_, motion, about));
      }
      fits.best = fit_robustly(model, fits.terms, config_.largest_mahalanobis2,
                               i == 0 ? start : fits.best, fits.weights);
    }
    support::Random random(config_.seed);
    for (std::uint32_t i = 0; i < config_.resamples; ++i) {
      std::vector<double> times(blocks_, 0.0);
      for (std::size_t b = 0; b < blocks_; ++b) times[random.below(blocks_)] += 1.0;
      std::vector<double> weights = fits.weights;
      for (std::size_t n = 0; n < weights.size(); ++n) {
        weights[n] *= times[motions_[n].first * blocks_ / stretches_.size()];
      }
      const bool any = std::any_of(weights.begin(), weights.end(), [](double w) { return w > 0; });
      if (any) fits.resampled.push_back(fit_noise(model, fits.terms, weights, fits.best));
      step();
    }
    return fits;
  }

 private:
  const OdometryCalibrationConfig& config_;
  std::span<const OdometryStretch> stretches_;
  std::span<const MeasuredMotion> motions_;
  std::size_t blocks_;
};

SystematicErrors systematic_errors(const Fits& fits) {
  const auto of = [&](Eigen::Index i) {
    return estimate(fits, [i](const NoiseFit& fit) { return fit.systematic[i]; });
  };
  return {of(0), of(1), of(2), of(3), of(4), of(5)};
}

/// Covariance of (ahead, left, yaw) over the resamples.
Eigen::Matrix3d mounting_covariance(const Fits& fits) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const NoiseFit& fit : fits.resampled) mean += fit.systematic.tail<3>();
  const auto count = static_cast<double>(fits.resampled.size());
  mean /= count;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const NoiseFit& fit : fits.resampled) {
    const Eigen::Vector3d off = fit.systematic.tail<3>() - mean;
    sum += off * off.transpose();
  }
  return sum / std::max(1.0, count - 1.0);
}

}  // namespace

OdometryCalibration calibrate_odometry(
    std::span<const OdometryStretch> stretches, std::span<const MeasuredMotion> motions,
    const OdometryCalibrationConfig& config,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  check_measurements(stretches, motions, config);
  const Coverage covered = coverage(stretches, motions);
  const bool path = covered.with_path >= kFewestStretches;
  const bool turn = covered.with_turn >= kFewestStretches;
  if (!path && !turn) {
    throw std::runtime_error(
        "too little motion: " + std::to_string(covered.stretches) +
        " measured stretches between stops, " + std::to_string(covered.with_path) +
        " of them 0.2 m long and " + std::to_string(covered.with_turn) +
        " with a turn of 0.2 rad, expected at least " + std::to_string(kFewestStretches));
  }

  FitModel model;
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    model.noise[p] = kOdometryParameters[p].per_turn ? turn : path;
  }
  std::size_t done = 0;
  const auto step = [&] {
    if (progress) progress(++done, 2 * std::size_t{config.resamples});
  };
  const Bootstrap bootstrap(stretches, motions, config);
  const Fits as_is = bootstrap.run(model, step);
  FitModel full = model;
  full.systematic = {path, path, turn, turn, turn, path};
  const Fits corrected = bootstrap.run(full, step);

  OdometryCalibration result;
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    const NoiseParameter& parameter = kOdometryParameters[p];
    NoiseEstimate& found = result.parameters[p];
    found.known = model.noise[p];
    found.stretches = parameter.per_turn ? covered.with_turn : covered.with_path;
    const double fallback = config.fallback.*parameter.field;
    const auto independent = static_cast<double>(covered.stretches);
    found.as_is = found.known ? bootstrap.noise(model, as_is, p, independent) : Estimate{fallback};
    found.corrected =
        found.known ? bootstrap.noise(full, corrected, p, independent) : Estimate{fallback};
    result.noise.*parameter.field = found.as_is.value;
  }
  result.systematic = systematic_errors(corrected);
  result.mounting_covariance = mounting_covariance(corrected);
  result.mounting_likelihood_covariance =
      systematic_covariance(full, corrected.terms, corrected.weights, corrected.best)
          .bottomRightCorner<3, 3>();
  result.motions = motions.size();
  result.outlying =
      static_cast<std::size_t>(std::count(as_is.weights.begin(), as_is.weights.end(), 0.0));
  result.motions -= result.outlying;
  result.measurement_scale = std::sqrt(as_is.best.measurement_factor);
  return result;
}

}  // namespace topogeo::localization
