// View from a stop in each direction, and the visibility of other points from there: free, seen,
// hidden.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// Measured range of the laser in each direction.
class RangeProfile {
 public:
  RangeProfile() = default;
  RangeProfile(std::span<const topomap::ScanPoint> points, const geometry::Pose2& T_robot_laser);

  enum class View : std::uint8_t {
    kUnknown,  ///< no reading in that direction
    kFree,     ///< the laser saw past it
    kSurface,  ///< about where the laser saw something
    kHidden,   ///< behind a surface that the laser saw
  };
  /// Visibility of a point (robot frame) in the scan. `tolerance_m` is the half-thickness of
  /// kSurface.
  [[nodiscard]] View view(const Eigen::Vector2d& point_robot_m, double tolerance_m) const {
    if (ranges_.empty()) return View::kUnknown;  // no scan
    const Eigen::Vector2d p = in_laser_frame(point_robot_m);
    const Range& seen = ranges_[static_cast<std::size_t>(bin_of(p))];
    if (seen.near_m == 0.0F) return View::kUnknown;
    const double range_m = std::sqrt(p.x() * p.x() + p.y() * p.y());
    if (range_m < static_cast<double>(seen.near_m) - tolerance_m) return View::kFree;
    return range_m <= static_cast<double>(seen.far_m) + tolerance_m ? View::kSurface
                                                                    : View::kHidden;
  }

  /// Whether a surface with this normal (SurfacePoint::normal, robot frame) faces away from the
  /// laser by more than 10 degrees, so that the laser cannot have seen it. False for normal 0.
  [[nodiscard]] bool turned_away(const Eigen::Vector2d& point_robot_m,
                                 const Eigen::Vector2d& normal) const {
    constexpr double kGrazing = 0.17364818;  // of 10 degrees: below that the face is not certain
    const double dx = laser_m_.x() - point_robot_m.x();
    const double dy = laser_m_.y() - point_robot_m.y();
    const double along_m = dx * normal.x() + dy * normal.y();
    return along_m < 0.0 && along_m * along_m > kGrazing * kGrazing * (dx * dx + dy * dy);
  }

  /// Like view(), but a face that is turned away is hidden, unless the laser saw past it.
  [[nodiscard]] View view_of_face(const Eigen::Vector2d& point_robot_m,
                                  const Eigen::Vector2d& normal, double tolerance_m) const {
    const View seen = view(point_robot_m, tolerance_m);
    return seen == View::kSurface && turned_away(point_robot_m, normal) ? View::kHidden : seen;
  }

 private:
  static constexpr int kBins = 720;  // half a degree
  static constexpr int kCellsPerQuadrant = 1024;
  using BinOfCell = std::array<std::int16_t, std::size_t{4} * kCellsPerQuadrant>;

  // Ranges of a bin and its neighbours; 0: no reading.
  struct Range {
    float near_m = 0.0F;
    float far_m = 0.0F;
  };

  static const BinOfCell& bin_of_cell();

  // Looked up by the slope within the quadrant: a match needs hundreds of directions, and half a
  // degree needs no arc tangent.
  [[nodiscard]] int bin_of(const Eigen::Vector2d& point_laser_m) const {
    const double ax = std::fabs(point_laser_m.x());
    const double ay = std::fabs(point_laser_m.y());
    if (ax + ay == 0.0) return kBins / 2;
    const double slope = ay / (ax + ay);  // 0 on the x axis, 1 on the y axis
    double turn = point_laser_m.x() >= 0.0 ? slope : 2.0 - slope;
    if (point_laser_m.y() < 0.0) turn = 4.0 - turn;
    const int cell =
        std::min(static_cast<int>(turn * kCellsPerQuadrant), 4 * kCellsPerQuadrant - 1);
    return (*bin_of_cell_)[static_cast<std::size_t>(cell)];
  }
  [[nodiscard]] Eigen::Vector2d in_laser_frame(const Eigen::Vector2d& point_robot_m) const {
    return {
        T_laser_robot_.x_m + rotation_.cos * point_robot_m.x() - rotation_.sin * point_robot_m.y(),
        T_laser_robot_.y_m + rotation_.sin * point_robot_m.x() + rotation_.cos * point_robot_m.y()};
  }

  Eigen::Vector2d laser_m_ = Eigen::Vector2d::Zero();  // robot frame
  geometry::Pose2 T_laser_robot_;
  geometry::SinCos rotation_{0.0, 1.0};  // of T_laser_robot_
  const BinOfCell* bin_of_cell_ = &bin_of_cell();
  std::vector<Range> ranges_;  // kBins of them, or none
};

}  // namespace topogeo::localization
