// Features of a local map for matching, extracted once per map: thinned scan points with the
// direction of the wall under them, the view from the stop, and the nodes and branches.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_config.hpp"
#include "topogeo/matching/nearest_point_grid.hpp"
#include "topogeo/matching/range_profile.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// A point of the scan. Two points that lie together belong to one surface only if they were seen
/// from the same side: a wall has two faces, and so has a rack.
struct SurfacePoint {
  Eigen::Vector2d position_m;
  /// Unit normal of the line through its neighbours, on the side that the laser saw; 0 if they do
  /// not lie on a line.
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
  bool on_line = false;  ///< the neighbours lie on a line
};

/// The same point, converted from frame b to frame a; `heading` of T_a_b.
inline SurfacePoint moved(const SurfacePoint& point, const geometry::Pose2& T_a_b,
                          const geometry::SinCos& heading) {
  const auto turned_x = [&](const Eigen::Vector2d& v) {
    return heading.cos * v.x() - heading.sin * v.y();
  };
  const auto turned_y = [&](const Eigen::Vector2d& v) {
    return heading.sin * v.x() + heading.cos * v.y();
  };
  return {{T_a_b.x_m + turned_x(point.position_m), T_a_b.y_m + turned_y(point.position_m)},
          {turned_x(point.normal), turned_y(point.normal)},
          point.on_line};
}
/// Converts points from frame b to frame a and appends them.
inline void add_moved(std::span<const SurfacePoint> points, const geometry::Pose2& T_a_b,
                      std::vector<SurfacePoint>& out) {
  const geometry::SinCos r = geometry::sincos(T_a_b.theta_rad);
  for (const SurfacePoint& point : points) out.push_back(moved(point, T_a_b, r));
}

/// A point on a branch, every `kBranchSpacing_m`.
struct BranchSample {
  Eigen::Vector2d position_m;
  Eigen::Vector2d direction;  ///< unit vector; its sign is arbitrary
  double clearance_m = 0.0;
  double slope = 0.0;   ///< of the clearance along the direction, m/m
  double weight = 1.0;  ///< repeatability, (0, 1]
};

/// Repeatability of a node: how surely it is found again from half a metre away, by its kind, (0,
/// 1] (tests/bench/repeatability.sh).
double repeatability(const topomap::LocalNode& node);

/// A branch from end to end, for the equations of the thesis.
struct BranchCurve {
  std::vector<Eigen::Vector2d>
      points_m;              ///< about kCurveSpacing_m apart, both ends included; at least two
  double clearance_m = 0.0;  ///< mean
};

/// A step where a wall continues further back: a jamb of a shut door, a pillar, a cupboard. In the
/// frame of its points.
struct WallEdge {
  Eigen::Vector2d position_m;  ///< on the front side
  Eigen::Vector2d direction;   ///< unit vector along the wall, towards the back side
  double step_m = 0.0;         ///< from the front to the back, > 0
  double sigma_m = 0.0;        ///< of the position along the wall, by the distance of two beams
};

/// The same edge, converted from frame b to frame a; `heading` of T_a_b.
inline WallEdge moved(const WallEdge& edge, const geometry::Pose2& T_a_b,
                      const geometry::SinCos& heading) {
  const SurfacePoint at = moved(SurfacePoint{edge.position_m, edge.direction}, T_a_b, heading);
  return {at.position_m, at.normal, edge.step_m, edge.sigma_m};
}

struct MatchFeatures {
  static constexpr double kFineSpacing_m = 0.05;
  static constexpr double kCoarseSpacing_m = 0.20;
  static constexpr double kBranchSpacing_m = 0.20;
  static constexpr double kCurveSpacing_m = 0.10;

  std::vector<SurfacePoint> surface;  ///< at least kFineSpacing_m apart along the scan
  std::vector<SurfacePoint> coarse;   ///< at least kCoarseSpacing_m apart along the scan
  std::vector<WallEdge> edges;        ///< at least 0.45 m apart
  RangeProfile profile;
  std::vector<topomap::LocalNode>
      nodes;  ///< real nodes and states of a branch, not fictitious or virtual
  std::vector<BranchSample> branches;  ///< of all confirmed branches that are not virtual
  std::vector<BranchCurve> curves;     ///< the same branches as whole curves
};

MatchFeatures extract_features(const topomap::LocalMap& map);

/// Only the scan's part of the features, for tracking between stops.
MatchFeatures extract_scan_features(std::span<const topomap::ScanPoint> points,
                                    const geometry::Pose2& T_robot_laser);

/// Features of the reference map of a match with look-up grids. The genetic search reads the arrays
/// in single precision; each ends with an extra element, far away, for places without a neighbour.
struct Reference {
  struct Branch {
    float x_m, y_m;
    float direction_x, direction_y;
    float clearance_m;
  };
  struct Surface {
    float x_m, y_m;
    float normal_x, normal_y;
  };
  std::shared_ptr<const MatchFeatures> features =
      std::make_shared<const MatchFeatures>();  ///< never null
  NearestPointGrid surface_grid;                ///< on features->surface
  NearestPointGrid branch_grid;                 ///< on features->branches
  std::vector<Surface> surfaces;
  std::vector<Branch> branches;
};

/// Points further apart than this, in metres, are not looked up in a reference. Fixed: the widest
/// kernel.
inline constexpr double kReach_m = 0.60;

/// Throws std::invalid_argument if the points lie too far apart (see NearestPointGrid::build).
Reference make_reference(MatchFeatures features);

/// Makes another reference in the memory of this one; `features` not null. If it throws, like
/// make_reference(), the reference must be made again.
void remake_reference(std::shared_ptr<const MatchFeatures> features, Reference& reference);

// The walls implied by the branches of a local map (own; docs/algorithms.md, "Refinement and
// gate"): a match by nodes and branches alone uses them in place of the scan.
//
// A branch with its clearance is the middle between two objects, and the circles of clearance along
// it touch both. The walls are the inverse of the medial axis transform (Harry Blum: A
// transformation for extracting new descriptors of shape, 1967). Walls beside no branch are
// missing: dead ends, and everything behind the end of a branch.

/// Places on walls in the robot frame, by bearing from the laser.
struct BranchWalls {
  std::vector<topomap::ScanPoint> points;
  geometry::Pose2 T_robot_laser;
};

/// Points where the circles of clearance of the branches touch; no scan point is read. Branches
/// that are not confirmed count, virtual ones do not: an object not seen yet can move an
/// unconfirmed branch, but the two objects on its sides were seen.
BranchWalls walls_of_branches(const topomap::LocalMap& map);

/// The nodes and branches of `features` with the walls in place of the scan.
MatchFeatures with_walls(const MatchFeatures& features, const BranchWalls& walls);

/// The points of a map for matches by this evidence: of the scan, or walls_of_branches().
std::vector<topomap::ScanPoint> points_for(const topomap::LocalMap& map, MatchEvidence evidence);

}  // namespace topogeo::localization
