// State of a place in one scan: free, occupied, or not seen.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

enum class Occupancy { kUnseen, kFree, kOccupied };

class ScanOccupancy {
 public:
  explicit ScanOccupancy(const ScanPoints& scan);

  /// `place_m` in the robot's frame at the time of the scan, with radius `radius_m`.
  [[nodiscard]] Occupancy at(const Eigen::Vector2d& place_m, double radius_m) const;

 private:
  struct Beam {
    double bearing_rad;
    double range_m;
    Eigen::Vector2d end_m;  ///< laser frame
  };
  geometry::Pose2 T_laser_robot_;
  std::vector<Beam> beams_;  ///< ascending by angle
};

}  // namespace topogeo::navigation
