#include "scan_units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace topogeo::recording {
namespace {

/// Farther than lasers of indoor robots measure, in metres; nearer than they see, in millimetres.
constexpr float kLarge = 100.0F;

float in_radians(float degrees) {
  return static_cast<float>(static_cast<double>(degrees) * std::numbers::pi / 180.0);
}

}  // namespace

bool correct_degrees(ros::LaserScan& scan) {
  constexpr double kLeastSpan = 8.0 * std::numbers::pi;  // more than four turns in radians
  constexpr double kTurn_deg = 361.0;                    // one step of rounding
  const double span = std::fabs(static_cast<double>(scan.angle_increment_())) *
                      (static_cast<double>(scan.ranges_().size()) - 1.0);
  if (!(span > kLeastSpan) || span > kTurn_deg ||
      !(std::fabs(static_cast<double>(scan.angle_min_())) <= kTurn_deg)) {
    return false;
  }
  scan.angle_min_(in_radians(scan.angle_min_()));
  scan.angle_max_(in_radians(scan.angle_max_()));
  scan.angle_increment_(in_radians(scan.angle_increment_()));
  return true;
}

void RangeUnit::add(const ros::LaserScan& scan) {
  for (const float range : scan.ranges_()) {
    if (!(range > 0.0F) || !std::isfinite(range)) continue;
    ++ranges_;
    if (range <= kLarge) continue;
    if (large_++ == 0) least_large_ = range;
    least_large_ = std::min(least_large_, range);
    largest_ = std::max(largest_, range);
  }
}

bool RangeUnit::is_millimetres() const {
  constexpr std::uint64_t kFewSmall = 20;  // one of so many
  constexpr float kVaries = 1.5F;          // a number for "no echo" does not
  return large_ > 0 && (ranges_ - large_) * kFewSmall <= ranges_ &&
         largest_ > kVaries * least_large_;
}

void convert_millimetres(ros::LaserScan& scan) {
  constexpr float kMetres = 0.001F;
  for (float& range : scan.ranges_()) range *= kMetres;
  if (scan.range_max_() > kLarge) scan.range_max_(scan.range_max_() * kMetres);
  if (scan.range_min_() > 1.0F) scan.range_min_(scan.range_min_() * kMetres);
}

}  // namespace topogeo::recording
