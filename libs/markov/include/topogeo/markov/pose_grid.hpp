// Probabilities of the errors of position and heading relative to odometry: a grid over x, y (axes
// of the map) and heading. It moves with the expected pose, so motion does not blur it; only errors
// of the heading and of odometry do.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::markov {

class PoseGrid {
 public:
  /// Sides in cells and headings, made odd. All zero.
  PoseGrid(int side, double cell_m, int headings, double heading_step_rad);

  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] int headings() const { return headings_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] double heading_step_rad() const { return heading_step_rad_; }
  /// Heading after heading, row after row, x within a row.
  [[nodiscard]] std::span<double> values() { return values_; }
  [[nodiscard]] std::span<const double> values() const { return values_; }
  [[nodiscard]] std::size_t index(int x, int y, int heading) const {
    return (static_cast<std::size_t>(heading) * static_cast<std::size_t>(side_) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  }
  /// Offset of a cell from the expected pose, metres and radians.
  [[nodiscard]] double offset_m(int cell) const {
    const int from_middle = cell - side_ / 2;
    return from_middle * cell_m_;
  }
  [[nodiscard]] double offset_rad(int heading) const {
    const int from_middle = heading - headings_ / 2;
    return from_middle * heading_step_rad_;
  }

  /// A normal distribution around the middle.
  void set_normal(double sigma_m, double sigma_rad);
  void set_uniform();
  /// The robot moves by `step_m` (map frame, as expected): a wrong heading leads elsewhere.
  void drive(const Eigen::Vector2d& step_m);
  /// Adds normal errors of this size in x and y, and in the heading.
  void blur(double sigma_m, double sigma_rad);
  /// Moves everything by whole cells and headings; values that leave the grid are lost.
  void shift(int by_x, int by_y, int by_heading);
  /// Normalizes the sum to one and negligible values to zero. False, without a change, if it is
  /// zero.
  bool normalize();

  struct Moments {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< m, m, rad off the expected pose
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };
  /// Moments of a normalized grid.
  [[nodiscard]] Moments moments() const;

 private:
  void blur_along(std::size_t stride, int length, double sigma_cells);

  int side_;
  int headings_;
  double cell_m_;
  double heading_step_rad_;
  std::vector<double> values_;
  std::vector<double> work_;
};

}  // namespace topogeo::markov
