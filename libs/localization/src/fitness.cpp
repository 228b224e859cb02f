#include "topogeo/localization/fitness.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr double kGridCell_m = 0.10;
constexpr double kReach_m = 0.60;       // further apart than this nothing is equivalent
constexpr double kScanKernel_m = 0.30;  // about twice the resolution of the genetic search
constexpr double kNodeWeight = 3.0;     // a node pins both coordinates, a branch sample only one
constexpr double kClearanceKernel_m = 0.30;
constexpr double kTopologicalShare = 0.3;  // of the combined form
// A prior that never vanishes: an optimistic odometry covariance must not veto the scans.
constexpr double kPriorSoftness = 12.0;

// 1 at 0, falling to 0 at `width`. Without a branch, which the CPU could not foresee.
double kernel(double squared_m2, double width_m) {
  const double u = std::max(0.0, 1.0 - squared_m2 / (width_m * width_m));
  return u * u;
}

struct Rotated {
  geometry::SinCos r;
  Pose2 T;
  explicit Rotated(const Pose2& pose) : r(geometry::sincos(pose.theta_rad)), T(pose) {}
  [[nodiscard]] Eigen::Vector2d point(const Eigen::Vector2d& p) const {
    return {T.x_m + r.cos * p.x() - r.sin * p.y(), T.y_m + r.sin * p.x() + r.cos * p.y()};
  }
  [[nodiscard]] Eigen::Vector2d direction(const Eigen::Vector2d& d) const {
    return {r.cos * d.x() - r.sin * d.y(), r.sin * d.x() + r.cos * d.y()};
  }
};

double node_score(const topomap::LocalNode& node, const Eigen::Vector2d& position,
                  const std::vector<topomap::LocalNode>& candidates) {
  double best = 0.0;
  for (const topomap::LocalNode& other : candidates) {
    const double near = kernel((other.position_m - position).squaredNorm(), kReach_m);
    if (near <= best) continue;
    const double difference = other.clearance_m - node.clearance_m;
    best = std::max(best, near * kernel(difference * difference, 2.0 * kClearanceKernel_m));
  }
  return best;
}

}  // namespace

Reference make_reference(MatchFeatures features) {
  Reference reference;
  std::vector<Eigen::Vector2d> surface;
  surface.reserve(features.surface.size());
  for (const SurfacePoint& p : features.surface) surface.push_back(p.position_m);
  reference.surface_grid.build(surface, kGridCell_m, kReach_m);
  std::vector<Eigen::Vector2d> branches;
  branches.reserve(features.branches.size());
  for (const BranchSample& s : features.branches) branches.push_back(s.position_m);
  reference.branch_grid.build(branches, kGridCell_m, kReach_m);
  reference.features = std::move(features);
  return reference;
}

Fitness::Fitness(const Reference& reference, const MatchFeatures& query, const MatchTask& task)
    : reference_(reference),
      query_(query),
      form_(task.fitness_form),
      T_prior_(task.T_reference_query),
      information_(task.covariance.inverse()) {}

double Fitness::topological(const Pose2& T_reference_query) const {
  const double weight = kNodeWeight * static_cast<double>(query_.nodes.size()) +
                        static_cast<double>(query_.branches.size());
  if (weight == 0.0) return 0.0;
  const Rotated pose(T_reference_query);
  double sum = 0.0;
  for (const topomap::LocalNode& node : query_.nodes) {
    sum += kNodeWeight * node_score(node, pose.point(node.position_m), reference_.features.nodes);
  }
  for (const BranchSample& sample : query_.branches) {
    const Eigen::Vector2d p = pose.point(sample.position_m);
    const std::int32_t found = reference_.branch_grid.find(p.x(), p.y());
    if (found == NearestPointGrid::kNone) continue;
    const BranchSample& other = reference_.features.branches[static_cast<std::size_t>(found)];
    const Eigen::Vector2d offset = p - other.position_m;
    // Distance to the branch, not to its sample: the part across the branch.
    const double across = offset.x() * other.direction.y() - offset.y() * other.direction.x();
    const double along2 = offset.squaredNorm() - across * across;
    const double half_m = 0.5 * MatchFeatures::kBranchSpacing_m;
    const double squared = across * across + std::max(0.0, along2 - half_m * half_m);
    const Eigen::Vector2d d = pose.direction(sample.direction);
    const double alignment = d.x() * other.direction.x() + d.y() * other.direction.y();
    const double difference = other.clearance_m - sample.clearance_m;
    sum += kernel(squared, kReach_m) * kernel(difference * difference, kClearanceKernel_m) *
           alignment * alignment;
  }
  return sum / weight;
}

double Fitness::scan(const Pose2& T_reference_query) const {
  if (query_.coarse_m.empty()) return 0.0;
  const Rotated pose(T_reference_query);
  double sum = 0.0;
  for (const Eigen::Vector2d& point : query_.coarse_m) {
    const Eigen::Vector2d p = pose.point(point);
    const std::int32_t found = reference_.surface_grid.find(p.x(), p.y());
    if (found == NearestPointGrid::kNone) continue;
    const auto& other = reference_.features.surface[static_cast<std::size_t>(found)];
    sum += kernel((other.position_m - p).squaredNorm(), kScanKernel_m);
  }
  return sum / static_cast<double>(query_.coarse_m.size());
}

double Fitness::prior(const Pose2& T_reference_query) const {
  const double d[3] = {T_reference_query.x_m - T_prior_.x_m, T_reference_query.y_m - T_prior_.y_m,
                       geometry::wrap_angle(T_reference_query.theta_rad - T_prior_.theta_rad)};
  double mahalanobis2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) mahalanobis2 += d[i] * information_(i, j) * d[j];
  }
  return 1.0 / (1.0 + mahalanobis2 / kPriorSoftness);
}

double Fitness::operator()(const Pose2& T_reference_query) const {
  if (form_ == FitnessForm::kTopological) return topological(T_reference_query);
  const double share = query_.branches.empty() && query_.nodes.empty() ? 0.0 : kTopologicalShare;
  return (share * topological(T_reference_query) + (1.0 - share) * scan(T_reference_query)) *
         prior(T_reference_query);
}

}  // namespace topogeo::localization
