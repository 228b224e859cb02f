// Principal axes of points in the plane in closed form: length, thickness and normal of their line.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace topogeo::localization {

struct PrincipalAxes {
  double smallest = 0.0;  ///< eigenvalues of the scatter matrix, not below 0
  double largest = 0.0;
  Eigen::Vector2d normal;  ///< eigenvector of the smallest, not of length 1; zero if undefined
};

/// `xx`, `xy`, `yy`: sums of squares and products about the mean.
inline PrincipalAxes principal_axes(double xx, double xy, double yy) {
  const double spread = std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
  const double smallest = std::max(0.0, 0.5 * (xx + yy) - spread);
  // The better conditioned row of (S - smallest I).
  return {smallest, 0.5 * (xx + yy) + spread,
          xx - smallest > yy - smallest ? Eigen::Vector2d(-xy, xx - smallest)
                                        : Eigen::Vector2d(yy - smallest, -xy)};
}

}  // namespace topogeo::localization
