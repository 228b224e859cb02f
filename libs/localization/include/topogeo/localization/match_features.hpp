// What matching reads of a local map, made once per map: thinned scan points with the direction of
// the wall under them, what was seen from the stop, and the nodes and branches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/nearest_point_grid.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// A point of the scan. `normal` is the unit normal of the line through its neighbours.
struct SurfacePoint {
  Eigen::Vector2d position_m;
  Eigen::Vector2d normal;
  bool on_line = false;  ///< the neighbours lie on a line; else `normal` means nothing
};

/// How far the laser saw in each direction.
class RangeProfile {
 public:
  RangeProfile() = default;
  RangeProfile(std::span<const topomap::ScanPoint> points, const geometry::Pose2& T_robot_laser);

  enum class View : std::uint8_t {
    kUnknown,  ///< no reading in that direction
    kFree,     ///< the laser saw past it
    kSurface,  ///< about where the laser saw something
    kHidden,   ///< behind what the laser saw
  };
  /// What the scan says of a point in the robot frame. `tolerance_m` is the half-thickness of
  /// kSurface.
  [[nodiscard]] View view(const Eigen::Vector2d& point_robot_m, double tolerance_m) const;

 private:
  static constexpr int kBins = 720;  // half a degree
  static int bin_of(const Eigen::Vector2d& point_laser_m);
  [[nodiscard]] Eigen::Vector2d in_laser_frame(const Eigen::Vector2d& point_robot_m) const;

  geometry::Pose2 T_laser_robot_;
  geometry::SinCos rotation_{0.0, 1.0};  // of T_laser_robot_
  std::vector<float>
      near_m_;  // smallest and largest range over a bin and its neighbours; 0: no reading
  std::vector<float> far_m_;
};

/// A point on a branch, every `kBranchSpacing_m`.
struct BranchSample {
  Eigen::Vector2d position_m;
  Eigen::Vector2d direction;  ///< unit vector; its sign means nothing
  double clearance_m = 0.0;
};

/// A branch from end to end, as the equations of the source need it.
struct BranchCurve {
  std::vector<Eigen::Vector2d>
      points_m;              ///< about kCurveSpacing_m apart, both ends included; at least two
  double clearance_m = 0.0;  ///< mean
};

struct MatchFeatures {
  static constexpr double kFineSpacing_m = 0.05;
  static constexpr double kCoarseSpacing_m = 0.20;
  static constexpr double kBranchSpacing_m = 0.20;
  static constexpr double kCurveSpacing_m = 0.10;

  std::vector<SurfacePoint> surface;      ///< at least kFineSpacing_m apart along the scan
  std::vector<Eigen::Vector2d> coarse_m;  ///< at least kCoarseSpacing_m apart along the scan
  RangeProfile profile;
  std::vector<topomap::LocalNode>
      nodes;  ///< real nodes and states of a branch; none fictitious or virtual
  std::vector<BranchSample> branches;  ///< of all confirmed branches that are not virtual
  std::vector<BranchCurve> curves;     ///< the same branches whole
};

MatchFeatures extract_features(const topomap::LocalMap& map);

/// Only the scan's part of the features, for tracking between stops.
MatchFeatures extract_scan_features(std::span<const topomap::ScanPoint> points,
                                    const geometry::Pose2& T_robot_laser);

/// Features of the reference map of a match together with the look-up grids on them. The arrays in
/// single precision are what the genetic search reads; each ends with one element more, far away,
/// for places that have no neighbour.
struct Reference {
  struct Branch {
    float x_m, y_m;
    float direction_x, direction_y;
    float clearance_m;
  };
  MatchFeatures features;
  NearestPointGrid surface_grid;  ///< on features.surface
  NearestPointGrid branch_grid;   ///< on features.branches
  std::vector<Eigen::Vector2f> surface_m;
  std::vector<Branch> branches;
};

/// Further apart than this, in metres, nothing is looked up in a reference.
inline constexpr double kReach_m = 0.60;

/// Throws std::invalid_argument when the points lie too far apart (see NearestPointGrid::build).
Reference make_reference(MatchFeatures features);

}  // namespace topogeo::localization
