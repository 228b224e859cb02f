#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {
namespace {

constexpr double kRounding = 1e-12;  // of products of variances, relative

void check_ellipse(const Eigen::Matrix2d& c, double k2) {
  if (!c.allFinite() || std::fabs(c(0, 1) - c(1, 0)) > kRounding * (c(0, 0) + c(1, 1))) {
    throw std::invalid_argument("error_ellipse: the covariance is not finite and symmetric");
  }
  const double product = c(0, 0) * c(1, 1);
  if (c(0, 0) < 0.0 || c(1, 1) < 0.0 || c(0, 1) * c(1, 0) > product * (1.0 + kRounding)) {
    throw std::invalid_argument("error_ellipse: the covariance is not positive semidefinite");
  }
  if (!(k2 >= 0.0 && std::isfinite(k2))) {
    throw std::invalid_argument("error_ellipse: k2 must be at least 0 and finite");
  }
}

}  // namespace

double ellipse_k2(double probability) {
  if (!(probability > 0.0 && probability < 1.0)) {
    throw std::invalid_argument("ellipse_k2: probability must lie between 0 and 1");
  }
  return -2.0 * geometry::log(1.0 - probability);
}

ErrorEllipse error_ellipse(const Eigen::Matrix2d& covariance_m2, double k2) {
  check_ellipse(covariance_m2, k2);
  const double xx = covariance_m2(0, 0);
  const double yy = covariance_m2(1, 1);
  const double xy = covariance_m2(0, 1);
  const double difference = xx - yy;
  const double major = 0.5 * (xx + yy + std::sqrt(difference * difference + 4.0 * xy * xy));
  // Determinant over the larger eigenvalue: the difference of 6.19 cancels in a long ellipse.
  const double minor = major > 0.0 ? std::max(0.0, (xx * yy - xy * xy) / major) : 0.0;
  // With A = yy/det, B = -xy/det, C = xx/det this is 1/2 atan2(-2B, C - A).
  return {std::sqrt(k2 * major), std::sqrt(k2 * minor),
          0.5 * geometry::atan2(2.0 * xy, difference)};
}

Eigen::Vector2d bounding_half_width_m(const ErrorEllipse& ellipse) {
  const geometry::SinCos r = geometry::sincos(ellipse.direction_rad);
  const double a2 = ellipse.semi_major_m * ellipse.semi_major_m;
  const double b2 = ellipse.semi_minor_m * ellipse.semi_minor_m;
  return {std::sqrt(a2 * r.cos * r.cos + b2 * r.sin * r.sin),
          std::sqrt(a2 * r.sin * r.sin + b2 * r.cos * r.cos)};
}

}  // namespace topogeo::localization
