#include "match_rivals.hpp"

#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/refinement.hpp"

#include "fitness_combined.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Fixed: verdicts depend on them, and tasks do not carry them.
constexpr double kNearest_m = 0.4;  // nearer ones are the same place or refine to it
constexpr double kStep_m = 0.2;     // the fitness has a reach of 0.3 m
constexpr int kMostSteps = 60;      // 12 m, beyond any scan worth comparing
constexpr int kRays = 8;            // the weakest direction, its opposite and six between

// Direction of the least certain position when the heading is free.
double weakest_direction_rad(const Eigen::Matrix3d& information) {
  constexpr double kLeastInformation = 0.25;
  const double per_heading = 1.0 / (information(2, 2) + kLeastInformation);
  const double xx = information(0, 0) - information(0, 2) * information(0, 2) * per_heading;
  const double xy = information(0, 1) - information(0, 2) * information(1, 2) * per_heading;
  const double yy = information(1, 1) - information(1, 2) * information(1, 2) * per_heading;
  return 0.5 * geometry::atan2(-2.0 * xy, yy - xx);
}

}  // namespace

MatchSolution strongest_rival(const MatchContext& context, const Pose2& T_found) {
  const auto& [task, reference, query, forms] = context;
  const double first_rad = weakest_direction_rad(information_at(reference, query, T_found));
  const geometry::SinCos heading = geometry::sincos(T_found.theta_rad);
  const auto searched = [&task = task](const Pose2& T) {
    return std::fabs(T.x_m - task.T_reference_query.x_m) <= task.half_width.x() &&
           std::fabs(T.y_m - task.T_reference_query.y_m) <= task.half_width.y();
  };
  MatchSolution rival;
  for (int ray = 0; ray < kRays; ++ray) {
    const geometry::SinCos to = geometry::sincos(first_rad + 2.0 * std::numbers::pi * ray / kRays);
    for (int step = 0; step < kMostSteps; ++step) {
      const double distance_m = kNearest_m + kStep_m * step;
      const Pose2 T{T_found.x_m + distance_m * to.cos, T_found.y_m + distance_m * to.sin,
                    T_found.theta_rad};
      if (!searched(T)) continue;
      const double fitness = forms.combined().of_maps(T, heading);
      if (fitness > rival.fitness) rival = {T, fitness};
    }
  }
  return rival;
}

}  // namespace topogeo::localization
