// The driven path and the parts of the map seen along it, for virtual links.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

struct VisitedStop {
  std::uint32_t map_id = 0;
  geometry::Pose2 T_map_robot;
  /// Its map has the id after that of the previous stop in DrivenPath::stops and belongs to the
  /// same drive, so the robot drove from there to here.
  bool follows = false;
  std::vector<Eigen::Vector2d> path_m;  ///< tracked scans since the previous stop, map frame
  std::vector<ScanPoint> points;        ///< of its scan, robot frame
  /// Places on the branches that vote for the map (real, on the main graph), map frame, nearest to
  /// the robot first.
  std::vector<Eigen::Vector2d> seen_m;

  /// Distance from a point of the map frame to the nearest scan point; 0 without points.
  [[nodiscard]] double clearance_m(const Eigen::Vector2d& point_m) const;
};

class DrivenPath {
 public:
  /// The next stop in time.
  void add(const LocalMap& map, const geometry::Pose2& T_map_robot);

  [[nodiscard]] const std::vector<VisitedStop>& stops() const { return stops_; }

 private:
  std::vector<VisitedStop> stops_;
};

}  // namespace topogeo::topomap
