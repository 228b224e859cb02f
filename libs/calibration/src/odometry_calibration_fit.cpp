#include "odometry_calibration_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <ceres/ceres.h>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr double kGauss = std::numeric_limits<double>::infinity();
constexpr double kStudent = 5.0;  // degrees of freedom of the first fit: heavy tails, fixed

Eigen::Matrix3d covariance(const MotionTerms& motion, const NoiseFit& fit) {
  Eigen::Matrix3d sum = fit.measurement_factor * motion.measurement;
  for (std::size_t p = 0; p < kNoiseParameters; ++p) sum += fit.noise[p] * motion.growth[p];
  return sum;
}

Eigen::Vector3d residual(const MotionTerms& motion, const NoiseFit& fit) {
  return motion.residual - motion.systematic * fit.systematic;
}

// Negative logarithm of the likelihood per motion. The variables are logarithms, because variances
// are positive and of unknown magnitude: first the factor of the measurements, then the parameters
// of the model.
class NegativeLogLikelihood : public ceres::FirstOrderFunction {
 public:
  NegativeLogLikelihood(const FitModel& model, std::span<const MotionTerms> motions,
                        std::span<const double> weights, const NoiseFit& fit, double freedom)
      : motions_(motions), weights_(weights), fit_(fit), freedom_(freedom) {
    for (std::size_t p = 0; p < kNoiseParameters; ++p) {
      if (model.noise[p]) active_.push_back(p);
      fit_.noise[p] = 0.0;
    }
    for (const double weight : weights) total_ += weight;
  }

  [[nodiscard]] int NumParameters() const override { return static_cast<int>(active_.size()) + 1; }

  [[nodiscard]] NoiseFit at(const double* x) const {
    NoiseFit fit = fit_;
    fit.measurement_factor = geometry::exp(x[0]);
    for (std::size_t i = 0; i < active_.size(); ++i) {
      fit.noise[active_[i]] = kSmallestNoise + geometry::exp(x[i + 1]);
    }
    return fit;
  }

  [[nodiscard]] std::vector<double> variables(const NoiseFit& fit) const {
    std::vector<double> x{geometry::log(fit.measurement_factor)};
    for (const std::size_t p : active_) {
      x.push_back(geometry::log(std::max(fit.noise[p] - kSmallestNoise, 1e-3 * kSmallestNoise)));
    }
    return x;
  }

  bool Evaluate(const double* x, double* cost, double* gradient) const override {
    const NoiseFit fit = at(x);
    // If all motions have one length, nothing separates the noise of the measurements from that of
    // the odometry. This prior then keeps the stated covariances, give or take a factor e.
    *cost = 0.5 * x[0] * x[0] / total_;
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(NumParameters());
    slope[0] = x[0] / total_;
    for (std::size_t n = 0; n < motions_.size(); ++n) {
      if (weights_[n] > 0.0) add(motions_[n], fit, weights_[n] / total_, *cost, slope);
    }
    if (gradient != nullptr) {
      gradient[0] = slope[0];
      for (std::size_t i = 0; i < active_.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i + 1);
        gradient[i + 1] = slope[k] * (fit.noise[active_[i]] - kSmallestNoise);
      }
    }
    return std::isfinite(*cost);
  }

 private:
  // Adds a motion; the gradient is with respect to the noise parameters themselves.
  void add(const MotionTerms& motion, const NoiseFit& fit, double weight, double& cost,
           Eigen::VectorXd& slope) const {
    const Eigen::Matrix3d sum = covariance(motion, fit);
    const Eigen::Matrix3d inverse = sum.inverse();
    const Eigen::Vector3d error = residual(motion, fit);
    const Eigen::Vector3d pull = inverse * error;
    const double distance2 = error.dot(pull);
    cost += 0.5 * weight * geometry::log(sum.determinant());
    double pull_weight = 1.0;
    if (freedom_ == kGauss) {
      cost += 0.5 * weight * distance2;
    } else {
      cost += 0.5 * weight * (freedom_ + 3.0) * geometry::log(1.0 + distance2 / freedom_);
      pull_weight = (freedom_ + 3.0) / (freedom_ + distance2);
    }
    const Eigen::Matrix3d by_sum = inverse - pull_weight * pull * pull.transpose();
    const auto by = [&](const Eigen::Matrix3d& part) {
      return 0.5 * weight * by_sum.cwiseProduct(part).sum();
    };
    slope[0] += by(motion.measurement) * fit.measurement_factor;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      slope[static_cast<Eigen::Index>(i + 1)] += by(motion.growth[active_[i]]);
    }
  }

  std::span<const MotionTerms> motions_;
  std::span<const double> weights_;
  NoiseFit fit_;
  double freedom_;
  std::vector<std::size_t> active_;
  double total_ = 0.0;
};

NoiseFit maximize(const FitModel& model, std::span<const MotionTerms> motions,
                  std::span<const double> weights, const NoiseFit& start, double freedom) {
  auto* likelihood = new NegativeLogLikelihood(model, motions, weights, start, freedom);
  std::vector<double> x = likelihood->variables(start);
  const ceres::GradientProblem problem(likelihood);  // owns it
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-9;
  options.gradient_tolerance = 1e-6;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, x.data(), &summary);
  return likelihood->at(x.data());
}

// Normal equations of the systematic errors for known noise: generalised least squares.
struct SystematicEquations {
  // Starts at 1, so that errors without data stay at 0. An error of 1 would mean no odometry.
  Eigen::Matrix<double, kSystematicErrors, kSystematicErrors> information =
      Eigen::Matrix<double, kSystematicErrors, kSystematicErrors>::Identity();
  SystematicVector sum = SystematicVector::Zero();
};

SystematicEquations normal_equations(const FitModel& model, std::span<const MotionTerms> motions,
                                     std::span<const double> weights, const NoiseFit& fit) {
  SystematicEquations equations;
  SystematicVector mask;
  for (int i = 0; i < kSystematicErrors; ++i) {
    mask[i] = model.systematic[static_cast<std::size_t>(i)] ? 1.0 : 0.0;
  }
  for (std::size_t n = 0; n < motions.size(); ++n) {
    if (weights[n] <= 0.0) continue;
    const Eigen::Matrix<double, 3, kSystematicErrors> by_error =
        motions[n].systematic * mask.asDiagonal();
    const Eigen::Matrix<double, kSystematicErrors, 3> weighted =
        weights[n] * by_error.transpose() * covariance(motions[n], fit).inverse();
    equations.information += weighted * by_error;
    equations.sum += weighted * motions[n].residual;
  }
  return equations;
}

NoiseFit fit_both(const FitModel& model, std::span<const MotionTerms> motions,
                  std::span<const double> weights, NoiseFit fit, double freedom) {
  const bool any = std::any_of(model.systematic.begin(), model.systematic.end(), std::identity{});
  constexpr int kRounds = 3;  // noise and systematic errors depend little on each other
  for (int round = 0; round < (any ? kRounds : 1); ++round) {
    if (any) {
      const SystematicEquations equations = normal_equations(model, motions, weights, fit);
      fit.systematic = equations.information.ldlt().solve(equations.sum);
    }
    fit = maximize(model, motions, weights, fit, freedom);
  }
  return fit;
}

/// The steps of a motion, and the pose before each.
struct Steps {
  std::vector<Pose2> steps;
  std::vector<Pose2> T_first_before;
  Pose2 T_first_last;
};

Steps steps_without(std::span<const OdometryStretch> stretches, const MeasuredMotion& motion,
                    const SystematicVector& systematic) {
  Steps found;
  for (std::uint32_t i = motion.first; i < motion.last; ++i) {
    for (const Pose2& measured : stretches[i]) {
      Pose2 step{measured.x_m / (1.0 + systematic[0]), measured.y_m / (1.0 + systematic[0]), 0.0};
      const double path_m = std::sqrt(step.position_m().squaredNorm());
      step.theta_rad = (measured.theta_rad - systematic[1] * path_m) / (1.0 + systematic[2]);
      found.T_first_before.push_back(found.T_first_last);
      found.steps.push_back(step);
      found.T_first_last = found.T_first_last * step;
    }
  }
  return found;
}

OdometryNoise noise_of(const NoiseFit& fit) {
  OdometryNoise noise;
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    noise.*kOdometryParameters[p].field = fit.noise[p];
  }
  return noise;
}

}  // namespace

MotionTerms make_terms(std::span<const OdometryStretch> stretches, const MeasuredMotion& motion,
                       const NoiseFit& about) {
  const Steps steps = steps_without(stretches, motion, about.systematic);
  const Eigen::Vector2d end = steps.T_first_last.position_m();
  const OdometryNoise noise = noise_of(about);

  MotionTerms terms;
  terms.measurement = motion.covariance;
  for (std::size_t p = 0; p < kNoiseParameters; ++p) {
    OdometryNoise one{0.0, 0.0, 0.0, 0.0, 0.0};
    one.*kOdometryParameters[p].field = 1.0;
    UncertainPose sum;
    for (const Pose2& step : steps.steps) sum = advance(sum, step, one);
    terms.growth[p] = sum.covariance;
  }
  // A longer path moves the end along; a turn swings everything beyond it, and the laser too.
  const geometry::SinCos r = geometry::sincos(steps.T_first_last.theta_rad);
  terms.systematic.setZero();
  terms.systematic.col(0) << end.x(), end.y(), 0.0;
  terms.systematic.col(3) << 1.0 - r.cos, -r.sin, 0.0;
  terms.systematic.col(4) << r.sin, 1.0 - r.cos, 0.0;
  terms.systematic.col(5) << -end.y(), end.x(), 0.0;
  // The mean of a step whose heading has the variance v is shorter by the factor 1 - v/2.
  double heading_rad2 = 0.0;
  Eigen::Vector2d shortening = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < steps.steps.size(); ++i) {
    const Pose2& step = steps.steps[i];
    const double path_m = std::sqrt(step.position_m().squaredNorm());
    const Eigen::Vector2d before = steps.T_first_before[i].position_m();
    const Eigen::Vector2d after = (steps.T_first_before[i] * step).position_m();
    const Eigen::Vector2d from_middle = end - 0.5 * (before + after);
    const Eigen::Vector2d from_after = end - after;
    terms.systematic.col(1) += path_m * Eigen::Vector3d(-from_middle.y(), from_middle.x(), 1.0);
    terms.systematic.col(2) +=
        step.theta_rad * Eigen::Vector3d(-from_after.y(), from_after.x(), 1.0);
    const double wander_rad2 = noise.heading_rad2_per_m * path_m;
    shortening += 0.5 * (heading_rad2 + 0.5 * wander_rad2) * (after - before);
    heading_rad2 += wander_rad2 + noise.heading_rad2_per_rad * std::fabs(step.theta_rad);
  }
  terms.residual = geometry::difference(steps.T_first_last, motion.T_first_last);
  terms.residual.head<2>() -= shortening;
  // `steps` already excludes the distance, heading and turn errors of `about`, but not its
  // mounting.
  SystematicVector taken_out = about.systematic;
  taken_out.tail<3>().setZero();
  terms.residual += terms.systematic * taken_out;
  return terms;
}

NoiseFit fit_noise(const FitModel& model, std::span<const MotionTerms> motions,
                   std::span<const double> weights, const NoiseFit& start) {
  return fit_both(model, motions, weights, start, kGauss);
}

NoiseFit fit_robustly(const FitModel& model, std::span<const MotionTerms> motions,
                      double largest_mahalanobis2, const NoiseFit& start,
                      std::vector<double>& weights) {
  weights.assign(motions.size(), 1.0);
  NoiseFit fit = fit_both(model, motions, weights, start, kStudent);
  // Grows from the core: every round adds the motions that the noise estimated so far explains.
  constexpr int kMostRounds = 20;  // a bound, in case two sets of motions alternate
  for (int round = 0; round < kMostRounds; ++round) {
    bool changed = round == 0;
    for (std::size_t n = 0; n < motions.size(); ++n) {
      const Eigen::Vector3d error = residual(motions[n], fit);
      const double distance2 = error.dot(covariance(motions[n], fit).inverse() * error);
      const double weight = distance2 <= largest_mahalanobis2 ? 1.0 : 0.0;
      changed = changed || weight != weights[n];
      weights[n] = weight;
    }
    if (!changed) break;
    fit = fit_noise(model, motions, weights, fit);
  }
  return fit;
}

Eigen::Matrix<double, kSystematicErrors, kSystematicErrors> systematic_covariance(
    const FitModel& model, std::span<const MotionTerms> motions, std::span<const double> weights,
    const NoiseFit& fit) {
  const auto information = normal_equations(model, motions, weights, fit).information.ldlt();
  Eigen::Matrix<double, kSystematicErrors, kSystematicErrors> inverse;
  for (int i = 0; i < kSystematicErrors; ++i) {
    const SystematicVector unit = SystematicVector::Unit(i);
    const SystematicVector column = information.solve(unit);  // quicker to compile than inverse()
    inverse.col(i) = column;
  }
  return inverse;
}

double upper_width(const FitModel& model, std::span<const MotionTerms> motions,
                   std::span<const double> weights, const NoiseFit& fit, std::size_t parameter,
                   double independent_motions) {
  const NegativeLogLikelihood likelihood(model, motions, weights, fit, kGauss);
  const auto loss = [&](double width) {
    NoiseFit wider = fit;
    wider.noise[parameter] += width;
    double cost = 0.0;
    likelihood.Evaluate(likelihood.variables(wider).data(), &cost, nullptr);
    return independent_motions * cost;
  };
  const double limit = loss(0.0) + 0.5;
  double low = 0.0;
  double high = kSmallestNoise;
  while (high < 1.0 && loss(high) < limit) {
    low = high;
    high *= 2.0;
  }
  while (high - low > 0.01 * high) {
    const double middle = 0.5 * (low + high);
    (loss(middle) < limit ? low : high) = middle;
  }
  return high;
}

}  // namespace topogeo::localization
