// Gauss-Newton for one pose, shared by all kinds of refinement.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/LU>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/refinement.hpp"

namespace topogeo::localization {

struct NormalEquations {
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  std::size_t points = 0;

  // Written out, because the sums must have the same order on every machine.
  void add(const double jacobian[3], double residual, double weight) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) hessian(i, j) += weight * jacobian[i] * jacobian[j];
      gradient(i) += weight * jacobian[i] * residual;
    }
    ++points;
  }

  // Adds the prior; its error and the update are (x, y, theta) in the reference frame.
  void add(const PosePrior& prior, const geometry::Pose2& T) {
    const Eigen::Vector3d error = geometry::difference(T, prior.T_reference_query);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        hessian(i, j) += prior.information(i, j);
        gradient(i) += prior.information(i, j) * error[j];
      }
    }
  }
};

/// Largest residual that counts: `first_m`, then `step_m` less at each iteration, down to `last_m`.
struct ShrinkingGate {
  double first_m;
  double last_m;
  double step_m;
};

/// Iterates from the first guess with the equations of linearize(T, gate_m). With fewer than
/// `fewest` points it returns the first guess, not converged.
template <typename Linearize>
Alignment align_with(const geometry::Pose2& T_first_guess, const PosePrior& prior,
                     const ShrinkingGate& gate, std::size_t fewest, const Linearize& linearize) {
  constexpr int kMostIterations = 15;  // fixed: bounds the time of a match
  Alignment result{T_first_guess, 0, false};
  geometry::Pose2& T = result.T_reference_query;
  for (int k = 0; k < kMostIterations; ++k) {
    const double gate_m = std::max(gate.last_m, gate.first_m - gate.step_m * k);
    NormalEquations equations = linearize(T, gate_m);
    if (equations.points < fewest) return {T_first_guess, k, false};
    equations.add(prior, T);
    // A little damping keeps a direction that nothing determines (along a bare corridor) unchanged.
    for (int i = 0; i < 3; ++i) equations.hessian(i, i) += 1e-3;
    const Eigen::Vector3d step = equations.hessian.inverse() * equations.gradient;
    T = {T.x_m - step.x(), T.y_m - step.y(), geometry::wrap_angle(T.theta_rad - step.z())};
    result.iterations = k + 1;
    const bool still =
        std::fabs(step.x()) < 1e-4 && std::fabs(step.y()) < 1e-4 && std::fabs(step.z()) < 1e-5;
    if (still && gate_m <= gate.last_m) {
      result.converged = true;
      break;
    }
  }
  return result;
}

}  // namespace topogeo::localization
