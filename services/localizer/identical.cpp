#include "identical.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace topogeo::localizer {

using localization::MatchResult;
using localization::MatchSolution;

namespace {

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const geometry::Pose2& a, const geometry::Pose2& b) {
  return same(a.x_m, b.x_m) && same(a.y_m, b.y_m) && same(a.theta_rad, b.theta_rad);
}

bool same_solution(const MatchSolution& a, const MatchSolution& b) {
  return same(a.T_reference_query, b.T_reference_query) && same(a.fitness, b.fitness);
}

}  // namespace

bool identical(const MatchResult& a, const MatchResult& b) {
  return a.task_id == b.task_id && a.status == b.status && a.evaluations == b.evaluations &&
         std::equal(a.solutions.begin(), a.solutions.end(), b.solutions.begin(), b.solutions.end(),
                    same_solution) &&
         same(a.T_reference_query, b.T_reference_query) &&
         std::equal(a.covariance.data(), a.covariance.data() + a.covariance.size(),
                    b.covariance.data(), [](double x, double y) { return same(x, y); }) &&
         same(a.overlap, b.overlap) && same(a.inliers, b.inliers) &&
         same(a.violations, b.violations) && same(a.residual_rms_m, b.residual_rms_m) &&
         same(a.scan_fitness, b.scan_fitness) &&
         same(a.topological_fitness, b.topological_fitness) && same(a.fitness, b.fitness) &&
         same_solution(a.second, b.second) && a.seed == b.seed && a.verdict == b.verdict &&
         a.reason == b.reason;
}

}  // namespace topogeo::localizer
