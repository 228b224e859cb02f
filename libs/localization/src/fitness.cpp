#include "topogeo/localization/fitness.hpp"

#include <algorithm>
#include <array>
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

// Elements that are looked up before the arithmetic on what was found: mixed, the jumps of the
// first hold up the second.
constexpr std::size_t kBlock = 64;

// 1 at 0, falling to 0 at `width`. The minimum, and not a test of the result, because compilers
// make a jump of the latter, which the CPU cannot foresee.
double kernel(double squared_m2, double width_m) {
  const double width2_m2 = width_m * width_m;
  const double u = 1.0 - (squared_m2 < width2_m2 ? squared_m2 : width2_m2) / width2_m2;
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

// A sample of the query's branches where the pose puts it, and the nearest one of the reference.
struct BranchPair {
  double x_m;
  double y_m;
  std::uint32_t query;
  std::int32_t reference;
};

double branch_score(const Rotated& pose, const BranchPair& pair, const BranchSample& sample,
                    const BranchSample& other) {
  const double x = pair.x_m - other.position_m.x();
  const double y = pair.y_m - other.position_m.y();
  // Distance to the branch, not to its sample: the part across the branch.
  const double across = x * other.direction.y() - y * other.direction.x();
  const double along2 = x * x + y * y - across * across;
  const double half_m = 0.5 * MatchFeatures::kBranchSpacing_m;
  const double beyond2 = along2 - half_m * half_m;
  const double squared = across * across + (beyond2 > 0.0 ? beyond2 : 0.0);
  const Eigen::Vector2d d = pose.direction(sample.direction);
  const double alignment = d.x() * other.direction.x() + d.y() * other.direction.y();
  const double difference = other.clearance_m - sample.clearance_m;
  return kernel(squared, kReach_m) * kernel(difference * difference, kClearanceKernel_m) *
         alignment * alignment;
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
  std::array<BranchPair, kBlock> pairs;
  for (std::size_t start = 0; start < query_.branches.size(); start += kBlock) {
    const std::size_t end = std::min(start + kBlock, query_.branches.size());
    std::size_t found = 0;
    for (std::size_t i = start; i < end; ++i) {
      const Eigen::Vector2d p = pose.point(query_.branches[i].position_m);
      const std::int32_t nearest = reference_.branch_grid.find(p.x(), p.y());
      pairs[found] = {p.x(), p.y(), static_cast<std::uint32_t>(i), nearest};
      found += nearest != NearestPointGrid::kNone ? 1 : 0;
    }
    for (std::size_t k = 0; k < found; ++k) {
      const BranchPair& pair = pairs[k];
      sum += branch_score(pose, pair, query_.branches[pair.query],
                          reference_.features.branches[static_cast<std::size_t>(pair.reference)]);
    }
  }
  return sum / weight;
}

double Fitness::scan(const Pose2& T_reference_query) const {
  if (query_.coarse_m.empty()) return 0.0;
  const Rotated pose(T_reference_query);
  double sum = 0.0;
  std::array<double, kBlock> squared_m2;
  for (std::size_t start = 0; start < query_.coarse_m.size(); start += kBlock) {
    const std::size_t end = std::min(start + kBlock, query_.coarse_m.size());
    std::size_t found = 0;
    for (std::size_t i = start; i < end; ++i) {
      const Eigen::Vector2d p = pose.point(query_.coarse_m[i]);
      const std::int32_t nearest = reference_.surface_grid.find(p.x(), p.y());
      if (nearest == NearestPointGrid::kNone) continue;
      const auto& other = reference_.features.surface[static_cast<std::size_t>(nearest)];
      squared_m2[found++] = (other.position_m - p).squaredNorm();
    }
    for (std::size_t k = 0; k < found; ++k) sum += kernel(squared_m2[k], kScanKernel_m);
  }
  return sum / static_cast<double>(query_.coarse_m.size());
}

double Fitness::prior(const Pose2& T_reference_query) const {
  const Eigen::Vector3d d = geometry::difference(T_reference_query, T_prior_);
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
