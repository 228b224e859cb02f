// Whether a scan fits the grid of the map at the pose of the robot: of a wrong pose that somebody
// has set, the hits lie in rooms, behind walls and outside, and not on walls.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

#include "channels/map_picture.hpp"

namespace topogeo::web {

/// The share of the hits that lie within 0.3 m of an occupied cell, from a sample of them; nothing
/// for too few hits.
std::optional<double> scan_fit(const MapPicture& map, const geometry::Pose2& T_map_robot,
                               const std::vector<Eigen::Vector2d>& hits_m);

/// Judges scan after scan, because one that passes people proves nothing.
class ScanFit {
 public:
  /// Scans in a row that must contradict the pose.
  static constexpr std::size_t kScans = 3;
  /// Below this share of hits on walls a scan contradicts the pose: right poses in rooms full of
  /// people and moved furniture have more.
  static constexpr double kLeast = 0.3;

  /// `fit`: share of the scan's hits that lie on walls.
  void add(double fit);
  /// False: the laser does not fit there. Nothing before the first scan.
  [[nodiscard]] std::optional<bool> last() const { return last_; }
  void forget() { *this = {}; }

 private:
  std::size_t misfits_ = 0;
  std::optional<bool> last_;
};

}  // namespace topogeo::web
