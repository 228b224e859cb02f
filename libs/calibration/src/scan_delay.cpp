#include "topogeo/calibration/scan_delay.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace topogeo::localization {
namespace {

constexpr std::int64_t kStep_ns = 10'000'000;
constexpr int kSteps = 50;  // to either side
// A smaller one moves a scan by less than matches correct, and buffers of drivers make it.
constexpr int kFewestSteps = 10;
// Errors of odometry and matches within a motion are smaller, most faults of either are larger.
constexpr double kFault_rad = 0.15;
constexpr double kContradicts_rad = 0.05;

/// Difference between the turn by the scans and that by odometry for each motion, at most
/// kFault_rad, which also counts where odometry is unknown.
std::vector<double> errors_rad(std::span<const LaserMotion> motions, const OdometryTurn& turn_rad,
                               double sign, std::int64_t delay_ns) {
  std::vector<double> errors;
  errors.reserve(motions.size());
  for (const LaserMotion& motion : motions) {
    const auto odometry_rad = turn_rad(motion.first_ns - delay_ns, motion.last_ns - delay_ns);
    const double error_rad =
        odometry_rad ? geometry::wrap_angle(sign * motion.T_laser.theta_rad - *odometry_rad)
                     : kFault_rad;
    errors.push_back(std::min(std::fabs(error_rad), kFault_rad));
  }
  return errors;
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

}  // namespace

std::optional<ScanDelay> find_scan_delay(std::span<const LaserMotion> motions,
                                         const OdometryTurn& turn_rad, bool upside_down) {
  const double sign = upside_down ? -1.0 : 1.0;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  int best_steps = 0;
  for (int steps = -kSteps; steps <= kSteps; ++steps) {
    std::vector<double> errors = errors_rad(motions, turn_rad, sign, steps * kStep_ns);
    const double cost = sum(errors);
    if (cost >= least) continue;
    least = cost;
    best_steps = steps;
    best = std::move(errors);
  }
  // At the end of what is searched, the right one is probably beyond.
  if (std::abs(best_steps) < kFewestSteps || std::abs(best_steps) == kSteps) return std::nullopt;
  const std::vector<double> without = errors_rad(motions, turn_rad, sign, 0);
  ScanDelay found{1e-9 * static_cast<double>(best_steps * kStep_ns), {}};
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (without[i] - best[i] > kContradicts_rad) ++found.votes.for_it;
    if (best[i] - without[i] > kContradicts_rad) ++found.votes.against;
  }
  return found.votes.decided() ? std::optional(found) : std::nullopt;
}

}  // namespace topogeo::localization
