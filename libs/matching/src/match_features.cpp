#include "topogeo/matching/match_features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "topogeo/geometry/portable_math.hpp"

#include "principal_axes.hpp"
#include "wall_edges.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using topomap::ScanPoint;

// Fixed: features depend on them, and tasks do not carry them.
constexpr double kNeighbourhood_m =
    0.30;  // wide enough for a normal despite centimetres of range noise
constexpr std::size_t kFewestNeighbours = 4;
constexpr double kLargestThickness_m = 0.05;

std::vector<Eigen::Vector2d> to_vectors(std::span<const ScanPoint> points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const ScanPoint& p : points) out.emplace_back(p.x_m, p.y_m);
  return out;
}

// Gap between two beams on one surface, as a share of the range: beams one degree apart on a wall
// seen at 75 degrees from its normal. If that gives too few neighbours, along corridors seen by
// coarse lasers, at 82 degrees. Not at once, because wider neighbourhoods round off corners, and
// not more, because a few points far apart make a poor line.
constexpr double kUsualGap = 0.07;
constexpr double kFlatGap = 0.14;

struct Neighbourhood {
  std::size_t first = 0;
  std::size_t last = 0;
  [[nodiscard]] bool few() const { return last - first + 1 < kFewestNeighbours; }
};

// Successive points around point i with gaps of at most this share of its range, up to a distance
// of two such gaps.
Neighbourhood neighbourhood(const std::vector<Eigen::Vector2d>& points, std::size_t i,
                            double range_m, double gap_share) {
  const double gap_m = std::max(0.15, gap_share * range_m);
  const double reach_m = std::max(kNeighbourhood_m, gap_share * range_m * 2.0);
  const auto within = [&](std::size_t a, std::size_t b, double distance_m) {
    return (points[a] - points[b]).squaredNorm() <= distance_m * distance_m;
  };
  Neighbourhood n{i, i};
  while (n.first > 0 && within(n.first - 1, i, reach_m) && within(n.first - 1, n.first, gap_m)) {
    --n.first;
  }
  while (n.last + 1 < points.size() && within(n.last + 1, i, reach_m) &&
         within(n.last + 1, n.last, gap_m)) {
    ++n.last;
  }
  return n;
}

// Line through the neighbours of point i by principal components, in closed form.
SurfacePoint fit_surface(const std::vector<Eigen::Vector2d>& points, std::size_t i,
                         const Eigen::Vector2d& laser_m) {
  const Eigen::Vector2d& centre = points[i];
  const double range_m = std::sqrt((centre - laser_m).squaredNorm());
  Neighbourhood around = neighbourhood(points, i, range_m, kUsualGap);
  if (around.few()) around = neighbourhood(points, i, range_m, kFlatGap);
  const auto [first, last] = around;
  const auto count = static_cast<double>(last - first + 1);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t k = first; k <= last; ++k) mean += points[k];
  mean /= count;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const double dx = points[k].x() - mean.x();
    const double dy = points[k].y() - mean.y();
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const auto [smallest, largest, normal] = principal_axes(xx, xy, yy);
  const double length = std::sqrt(normal.squaredNorm());
  const bool on_line = !around.few() && length > 0.0 && smallest < 0.1 * largest &&
                       smallest <= count * kLargestThickness_m * kLargestThickness_m;
  if (!on_line) return {centre};
  const bool seen_from_behind = normal.dot(laser_m - centre) < 0.0;
  return {centre, normal / (seen_from_behind ? -length : length), true};
}

// A finer grid where it costs little: in a hall it would take longer to fill than the match.
double grid_cell_m(const std::vector<SurfacePoint>& points) {
  constexpr double kFine_m = 0.10;
  constexpr double kLargestFineExtent_m = 50.0;
  if (points.empty()) return kFine_m;
  Eigen::AlignedBox2d box;
  for (const SurfacePoint& p : points) box.extend(p.position_m);
  return box.sizes().maxCoeff() <= kLargestFineExtent_m ? kFine_m : 2.0 * kFine_m;
}

// Share of the points of confirmed branches that are found again half a metre away: freiburg-079
// and intel together (docs/decisions/perception.md).
constexpr double kFoundAgain = 0.84;

void add_branch_samples(const topomap::LocalBranch& branch, std::vector<BranchSample>& out) {
  const auto& points = branch.points;
  double since_m = MatchFeatures::kBranchSpacing_m;
  for (std::size_t i = 1; i < points.size(); ++i) {
    since_m += std::sqrt((points[i].position_m - points[i - 1].position_m).squaredNorm());
    if (since_m < MatchFeatures::kBranchSpacing_m) continue;
    since_m = 0.0;
    const std::size_t before = i >= 3 ? i - 3 : 0;
    const std::size_t after = std::min(points.size() - 1, i + 3);
    Eigen::Vector2d direction = points[after].position_m - points[before].position_m;
    const double length = std::sqrt(direction.squaredNorm());
    if (length <= 0.0) continue;
    const double slope = (points[after].clearance_m - points[before].clearance_m) / length;
    out.push_back(
        {points[i].position_m, direction / length, points[i].clearance_m, slope, kFoundAgain});
  }
}

BranchCurve whole_branch(const topomap::LocalBranch& branch) {
  constexpr double kSpacing2 = MatchFeatures::kCurveSpacing_m * MatchFeatures::kCurveSpacing_m;
  BranchCurve curve;
  for (const topomap::BranchPoint& point : branch.points) {
    curve.clearance_m += point.clearance_m;
    if (curve.points_m.empty() ||
        (point.position_m - curve.points_m.back()).squaredNorm() >= kSpacing2) {
      curve.points_m.push_back(point.position_m);
    }
  }
  curve.clearance_m /= static_cast<double>(branch.points.size());
  if (curve.points_m.size() > 1) curve.points_m.pop_back();
  curve.points_m.push_back(branch.points.back().position_m);
  return curve;
}

}  // namespace

double repeatability(const topomap::LocalNode& node) {
  return node.kind == topomap::NodeKind::kReal ? 0.65 : 0.73;
}

MatchFeatures extract_scan_features(std::span<const ScanPoint> points, const Pose2& T_robot_laser) {
  MatchFeatures features;
  const std::vector<Eigen::Vector2d> all = to_vectors(points);
  const Eigen::Vector2d laser_m = T_robot_laser.position_m();
  const auto far_enough = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, double spacing_m) {
    return (a - b).squaredNorm() >= spacing_m * spacing_m;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (features.surface.empty() ||
        far_enough(features.surface.back().position_m, all[i], MatchFeatures::kFineSpacing_m)) {
      features.surface.push_back(fit_surface(all, i, laser_m));
    }
    if (features.coarse.empty() ||
        far_enough(features.coarse.back().position_m, all[i], MatchFeatures::kCoarseSpacing_m)) {
      const bool kept = features.surface.back().position_m == all[i];
      features.coarse.push_back(kept ? features.surface.back() : fit_surface(all, i, laser_m));
    }
  }
  features.profile = RangeProfile(points, T_robot_laser);
  features.edges = find_wall_edges(all, laser_m);
  return features;
}

MatchFeatures extract_features(const topomap::LocalMap& map) {
  MatchFeatures features = extract_scan_features(map.points, map.T_robot_laser);
  for (const topomap::LocalNode& node : map.nodes) {
    if (node.kind != topomap::NodeKind::kFictitious && node.kind != topomap::NodeKind::kVirtual) {
      features.nodes.push_back(node);
    }
  }
  for (const topomap::LocalBranch& branch : map.branches) {
    if (branch.is_virtual || !branch.confirmed || branch.points.empty()) continue;
    add_branch_samples(branch, features.branches);
    features.curves.push_back(whole_branch(branch));
  }
  return features;
}

Reference make_reference(MatchFeatures features) {
  Reference reference;
  remake_reference(std::make_shared<const MatchFeatures>(std::move(features)), reference);
  return reference;
}

void remake_reference(std::shared_ptr<const MatchFeatures> made_of, Reference& reference) {
  constexpr float kFarAway_m = 1e9F;
  const MatchFeatures& features = *made_of;
  const double cell_m = grid_cell_m(features.surface);
  std::vector<Eigen::Vector2d> positions_m;
  positions_m.reserve(std::max(features.surface.size(), features.branches.size()));
  reference.surfaces.clear();
  reference.surfaces.reserve(features.surface.size() + 1);
  for (const SurfacePoint& p : features.surface) {
    positions_m.push_back(p.position_m);
    const Eigen::Vector2f at_m = p.position_m.cast<float>();
    const Eigen::Vector2f normal = p.normal.cast<float>();
    reference.surfaces.push_back({at_m.x(), at_m.y(), normal.x(), normal.y()});
  }
  reference.surfaces.push_back({kFarAway_m, kFarAway_m, 0.0F, 0.0F});
  reference.surface_grid.build(positions_m, cell_m, kReach_m);
  positions_m.clear();
  reference.branches.clear();
  reference.branches.reserve(features.branches.size() + 1);
  for (const BranchSample& s : features.branches) {
    positions_m.push_back(s.position_m);
    const Eigen::Vector2f p = s.position_m.cast<float>();
    const Eigen::Vector2f d = s.direction.cast<float>();
    reference.branches.push_back({p.x(), p.y(), d.x(), d.y(), static_cast<float>(s.clearance_m)});
  }
  reference.branches.push_back({kFarAway_m, kFarAway_m, 0.0F, 0.0F, 0.0F});
  reference.branch_grid.build(positions_m, cell_m, kReach_m);
  reference.features = std::move(made_of);
}

}  // namespace topogeo::localization
