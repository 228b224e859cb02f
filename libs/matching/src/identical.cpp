#include <algorithm>
#include <bit>
#include <cstdint>

#include "topogeo/matching/match.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

bool identical_solutions(const MatchSolution& a, const MatchSolution& b) {
  return identical(a.T_reference_query, b.T_reference_query) && identical(a.fitness, b.fitness);
}

}  // namespace

bool identical(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool identical(const Pose2& a, const Pose2& b) {
  return identical(a.x_m, b.x_m) && identical(a.y_m, b.y_m) && identical(a.theta_rad, b.theta_rad);
}

bool identical(const MatchResult& a, const MatchResult& b) {
  return a.task_id == b.task_id && a.status == b.status && a.evaluations == b.evaluations &&
         std::equal(a.solutions.begin(), a.solutions.end(), b.solutions.begin(), b.solutions.end(),
                    identical_solutions) &&
         identical(a.T_reference_query, b.T_reference_query) &&
         std::equal(a.covariance.data(), a.covariance.data() + a.covariance.size(),
                    b.covariance.data(), [](double x, double y) { return identical(x, y); }) &&
         identical(a.overlap, b.overlap) && identical(a.inliers, b.inliers) &&
         identical(a.violations, b.violations) && identical(a.residual_rms_m, b.residual_rms_m) &&
         identical(a.scan_fitness, b.scan_fitness) &&
         identical(a.topological_fitness, b.topological_fitness) &&
         identical(a.fitness, b.fitness) && identical_solutions(a.second, b.second) &&
         a.seed == b.seed && a.verdict == b.verdict && a.reason == b.reason;
}

}  // namespace topogeo::localization
