#include "fitness_combined.hpp"

#include <algorithm>
#include <array>

#include <Eigen/LU>

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using geometry::SinCos;

// Fixed: fitness depends on them, and tasks do not carry them.
constexpr double kTopologicalShare = 0.3;
constexpr double kPriorSoftness = 12.0;  // squared deviations at which the prior is one half
constexpr float kOtherFace = -0.5F;      // cosine between the normals of the two faces of a wall
constexpr float kScanKernel_m = 0.30F;   // about twice the resolution of the genetic search

}  // namespace

void ScanFitness::bind(const Reference& reference, const MatchFeatures& query) {
  reference_ = &reference;
  for (LaneArray* numbers : {&x_m_, &y_m_, &normal_x_, &normal_y_}) numbers->clear();
  for (const SurfacePoint& p : query.coarse) {
    x_m_.add(p.position_m.x());
    y_m_.add(p.position_m.y());
    normal_x_.add(p.normal.x());
    normal_y_.add(p.normal.y());
  }
  x_m_.pad(kPadding_m);
  y_m_.pad(kPadding_m);
  normal_x_.pad(0.0);
  normal_y_.pad(0.0);
  per_point_ = query.coarse.empty() ? 0.0 : 1.0 / static_cast<double>(query.coarse.size());
}

double ScanFitness::at(const Pose2& T_reference_query, const SinCos& heading) const {
  const auto x_m = static_cast<float>(T_reference_query.x_m);
  const auto y_m = static_cast<float>(T_reference_query.y_m);
  const auto sine = static_cast<float>(heading.sin);
  const auto cosine = static_cast<float>(heading.cos);
  Lanes sums = Lanes::Zero();
  for (std::size_t first = 0; first < x_m_.size(); first += kBlock) {
    const std::size_t end = std::min(first + kBlock, x_m_.size());
    // Differences to the nearest points and their normals: first all look-ups, then the arithmetic.
    alignas(16) std::array<float, kBlock> dx_m, dy_m, normal_x, normal_y;
    for (std::size_t i = first; i < end; i += 4) {
      const Lanes x = x_m + cosine * x_m_.lanes(i) - sine * y_m_.lanes(i);
      const Lanes y = y_m + sine * x_m_.lanes(i) + cosine * y_m_.lanes(i);
      const std::array<std::size_t, 4> found = reference_->surface_grid.find_four(x, y);
      for (std::size_t k = 0; k < 4; ++k) {
        const Reference::Surface& other = reference_->surfaces[found[k]];
        const std::size_t at = i - first + k;
        dx_m[at] = x[static_cast<Eigen::Index>(k)] - other.x_m;
        dy_m[at] = y[static_cast<Eigen::Index>(k)] - other.y_m;
        normal_x[at] = other.normal_x;
        normal_y[at] = other.normal_y;
      }
    }
    for (std::size_t i = 0; i < end - first; i += 4) {
      const Eigen::Map<const Lanes, Eigen::Aligned16> dx(&dx_m[i]);
      const Eigen::Map<const Lanes, Eigen::Aligned16> dy(&dy_m[i]);
      const Eigen::Map<const Lanes, Eigen::Aligned16> other_x(&normal_x[i]);
      const Eigen::Map<const Lanes, Eigen::Aligned16> other_y(&normal_y[i]);
      const Lanes x = normal_x_.lanes(first + i);
      const Lanes y = normal_y_.lanes(first + i);
      const Lanes facing = (cosine * x - sine * y) * other_x + (sine * x + cosine * y) * other_y;
      const Lanes near = kernel(dx * dx + dy * dy, kScanKernel_m);
      sums += (facing > kOtherFace).select(near, Lanes::Zero());
    }
  }
  return std::min(1.0, sum_of(sums) * per_point_);
}

void OdometryPrior::bind(const MatchTask& task) {
  T_predicted_ = task.T_reference_query;
  information_ = task.covariance.inverse();
}

double OdometryPrior::operator()(const Pose2& T_reference_query) const {
  const Eigen::Vector3d d = geometry::difference(T_reference_query, T_predicted_);
  double mahalanobis2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) mahalanobis2 += d[i] * information_(i, j) * d[j];
  }
  return 1.0 / (1.0 + mahalanobis2 / kPriorSoftness);
}

void CombinedFitness::bind(const Reference& reference, const MatchFeatures& query,
                           const MatchTask& task) {
  topological_.bind(reference, query);
  scan_.bind(reference, query);
  prior_.bind(task);
}

double CombinedFitness::at(const Pose2& T_reference_query, const SinCos& heading) const {
  return of_maps(T_reference_query, heading) * prior_(T_reference_query);
}

double CombinedFitness::of_maps(const Pose2& T_reference_query, const SinCos& heading) const {
  const double scan = scan_.at(T_reference_query, heading);
  if (topological_.empty()) return scan;
  return kTopologicalShare * topological_.at(T_reference_query, heading) +
         (1.0 - kTopologicalShare) * scan;
}

}  // namespace topogeo::localization
