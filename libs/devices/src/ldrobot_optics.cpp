#include "topogeo/devices/ldrobot_optics.hpp"

#include <cmath>
#include <numbers>

namespace topogeo::devices {
namespace {

constexpr double kAhead_mm = 5.9;
constexpr double kAside_mm = -20.14;
constexpr double kAside = 0.11923;  // for each millimetre of distance

}  // namespace

Ld08Point ld08_point(double distance_mm) {
  const double x_mm = distance_mm + kAhead_mm;
  const double y_mm = kAside * distance_mm + kAside_mm;
  return {std::hypot(x_mm, y_mm), std::atan2(y_mm, x_mm) * 180.0 / std::numbers::pi};
}

/// The positive solution d of (d + a)^2 + (b d + c)^2 = r^2.
double ld08_distance_mm(double range_mm) {
  constexpr double kSquare = 1.0 + kAside * kAside;
  constexpr double kHalf = kAhead_mm + kAside * kAside_mm;
  const double rest = kAhead_mm * kAhead_mm + kAside_mm * kAside_mm - range_mm * range_mm;
  const double root = kHalf * kHalf - kSquare * rest;
  if (root <= 0.0) return 0.0;
  return std::fmax(0.0, (std::sqrt(root) - kHalf) / kSquare);
}

}  // namespace topogeo::devices
