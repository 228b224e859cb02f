// The region seen by one scan: the polygon of its points and its openings.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

class SeenRegion {
 public:
  /// Builds the region from the scan points of `map`, in beam order seen from the laser.
  /// Consecutive points farther apart than gap_m have an opening between them.
  SeenRegion(const LocalMap& map, double gap_m);

  /// Whether the point (robot frame) was seen and nothing unseen lies within radius_m of it. The
  /// diagram at such a point is the same as in a fully known environment.
  [[nodiscard]] bool certain(const Eigen::Vector2d& point_m, double radius_m) const;

 private:
  struct Segment {
    Eigen::Vector2d from_m;
    Eigen::Vector2d along_m;
    double length2_m2 = 0.0;
  };

  /// Neighbouring openings with their bounding box. A point that is far from the box needs no check
  /// of each opening.
  struct Openings {
    std::size_t begin = 0;
    std::size_t end = 0;
    Eigen::AlignedBox2d box_m;
  };

  void add_opening(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);
  void group_openings();
  [[nodiscard]] bool seen(const Eigen::Vector2d& point_m) const;

  Eigen::Vector2d origin_m_;
  std::vector<Eigen::Vector2d> points_m_;
  std::vector<double> angles_rad_;  // bearing of the points from the laser, ascending
  std::vector<Segment> openings_;   // along the polygon
  std::vector<Openings> groups_;
};

}  // namespace topogeo::topomap
