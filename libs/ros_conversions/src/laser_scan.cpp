#include "topogeo/ros_conversions/laser_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/Core>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/scan/deskew.hpp"

namespace topogeo::ros {
namespace {

constexpr float kNoEcho = scan::Scan::kNoReturn;
// A full turn plus a rounded step, a hundredth of the finest laser's step.
constexpr double kTurn_rad = 2.0 * std::numbers::pi + 0.01;
constexpr double kFinest_rad = 1e-5;
/// All mirrors turn faster.
constexpr double kLongestSweep_s = 10.0;

void require(bool good, const char* field, const std::string& expected, double got) {
  if (good) return;
  throw std::invalid_argument(std::string(field) + ": expected " + expected + ", got " +
                              std::to_string(got));
}

/// The pattern of the kept beams, and their order in the message.
struct Layout {
  BeamPattern pattern;
  std::size_t every = 1;  ///< keep each `every`-th beam of the message
  bool reversed = false;  ///< the last beam of the message comes first
};

Layout layout_of(const LaserScan& message, bool upside_down, std::size_t most_beams) {
  const std::size_t count = message.ranges_().size();
  require(count >= 2, "ranges", "2 or more", static_cast<double>(count));
  const auto start_rad = static_cast<double>(message.angle_min_());
  auto increment_rad = static_cast<double>(message.angle_increment_());
  // Some drivers leave it out and state the last angle.
  if (increment_rad == 0.0) {
    increment_rad =
        (static_cast<double>(message.angle_max_()) - start_rad) / static_cast<double>(count - 1);
  }
  require(std::fabs(start_rad) <= kTurn_rad, "angle_min", "a number within one turn", start_rad);
  require(std::fabs(increment_rad) >= kFinest_rad &&
              std::fabs(increment_rad) * static_cast<double>(count - 1) <= kTurn_rad,
          "angle_increment",
          "0.00001 or more to either side, and one turn at most for " + std::to_string(count) +
              " ranges",
          increment_rad);
  Layout layout;
  layout.every = (count + most_beams - 1) / most_beams;
  layout.pattern.beams = (count + layout.every - 1) / layout.every;
  const double turn = upside_down ? -1.0 : 1.0;
  const double first_rad = turn * start_rad;
  const double step_rad = turn * increment_rad * static_cast<double>(layout.every);
  layout.reversed = step_rad < 0.0;
  layout.pattern.angle_step_rad = std::fabs(step_rad);
  layout.pattern.angle_min_rad =
      layout.reversed ? first_rad + static_cast<double>(layout.pattern.beams - 1) * step_rad
                      : first_rad;
  return layout;
}

double angle_of(const BeamPattern& pattern, std::size_t beam) {
  return pattern.angle_min_rad + static_cast<double>(beam) * pattern.angle_step_rad;
}

double last_angle_of(const BeamPattern& pattern) {
  return angle_of(pattern, pattern.beams - 1);
}

}  // namespace

std::string text_of(const BeamPattern& pattern) {
  char text[96];
  std::snprintf(text, sizeof(text), "%zu beams from %.4f rad by %.5f rad", pattern.beams,
                pattern.angle_min_rad, pattern.angle_step_rad);
  return text;
}

bool same_beams(const BeamPattern& a, const BeamPattern& b) {
  constexpr double kSame_rad = 1e-4;
  return a.beams == b.beams && std::fabs(a.angle_min_rad - b.angle_min_rad) <= kSame_rad &&
         std::fabs(last_angle_of(a) - last_angle_of(b)) <= kSame_rad;
}

bool alike(const BeamPattern& a, const BeamPattern& b) {
  const double common_rad =
      std::min(last_angle_of(a), last_angle_of(b)) - std::max(a.angle_min_rad, b.angle_min_rad);
  const double wider_rad =
      std::max(last_angle_of(a) - a.angle_min_rad, last_angle_of(b) - b.angle_min_rad);
  const double finer_rad = std::min(a.angle_step_rad, b.angle_step_rad);
  return common_rad >= 0.5 * wider_rad &&
         std::max(a.angle_step_rad, b.angle_step_rad) <= 2.0 * finer_rad;
}

SweepOrder sweep_order(std::string_view name) {
  if (name == "none") return SweepOrder::kNone;
  if (name == "forward") return SweepOrder::kForward;
  if (name == "backward") return SweepOrder::kBackward;
  throw std::invalid_argument("sweep: expected none, forward or backward, got " +
                              std::string(name));
}

BeamPattern pattern_of(const LaserScan& message, bool upside_down, std::size_t most_beams) {
  return layout_of(message, upside_down, most_beams).pattern;
}

Sweep to_sweep(const LaserScan& message, bool upside_down, std::size_t most_beams,
               SweepOrder order) {
  const Layout layout = layout_of(message, upside_down, most_beams);
  const auto time_step_s = static_cast<double>(message.time_increment_());
  if (order != SweepOrder::kNone) {  // nothing else uses it
    require(time_step_s >= 0.0 &&
                time_step_s * static_cast<double>(message.ranges_().size()) <= kLongestSweep_s,
            "time_increment", "0 or more, and 10 s at most for all ranges", time_step_s);
  }

  Sweep sweep;
  sweep.pattern = layout.pattern;
  const std::size_t beams = layout.pattern.beams;
  if (order != SweepOrder::kNone) {
    sweep.time_step_s = time_step_s * static_cast<double>(layout.every);
  }
  if (order == SweepOrder::kBackward) sweep.time_step_s = -sweep.time_step_s;
  if (layout.reversed) {
    sweep.first_beam_s = sweep.time_step_s * static_cast<double>(beams - 1);
    sweep.time_step_s = -sweep.time_step_s;
  }
  const float least_m = message.range_min_();
  const bool states_limit = message.range_max_() > least_m && message.range_max_() > 0.0F;
  const float limit_m =
      states_limit ? message.range_max_() : std::numeric_limits<float>::infinity();
  sweep.ranges_m.reserve(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const float range_m = message.ranges_()[(layout.reversed ? beams - 1 - i : i) * layout.every];
    const bool echo = range_m > 0.0F && range_m < limit_m && !(range_m < least_m);
    sweep.ranges_m.push_back(echo ? range_m : kNoEcho);
  }
  return sweep;
}

std::vector<float> on_pattern(const Sweep& sweep, const BeamPattern& pattern) {
  std::vector<float> ranges_m(pattern.beams, kNoEcho);
  const double reach_rad = 0.5 * std::max(sweep.pattern.angle_step_rad, pattern.angle_step_rad);
  for (std::size_t i = 0; i < pattern.beams; ++i) {
    const double angle_rad = angle_of(pattern, i);
    const double place = (angle_rad - sweep.pattern.angle_min_rad) / sweep.pattern.angle_step_rad;
    const double nearest = std::round(place);
    if (nearest < 0.0 || nearest >= static_cast<double>(sweep.ranges_m.size())) continue;
    if (std::fabs(place - nearest) * sweep.pattern.angle_step_rad > reach_rad * (1.0 + 1e-6))
      continue;
    ranges_m[i] = sweep.ranges_m[static_cast<std::size_t>(nearest)];
  }
  return ranges_m;
}

std::vector<float> deskewed(
    const Sweep& sweep,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after) {
  return scan::deskewed(
      {{sweep.pattern.angle_min_rad, sweep.pattern.angle_step_rad, sweep.pattern.beams},
       sweep.ranges_m,
       sweep.first_beam_s,
       sweep.time_step_s},
      T_odom_laser_after);
}

void limit_ranges(std::vector<float>& ranges_m, double range_limit_m) {
  const auto limit_m = static_cast<float>(range_limit_m);
  for (float& range_m : ranges_m) {
    if (!(range_m < limit_m)) range_m = kNoEcho;
  }
}

LaserScan to_laser_scan(const scan::Scan& scan, const std::string& frame_id, float range_max_m) {
  LaserScan message;
  message.header_(header_of(frame_id, scan.stamp_ns));
  message.angle_min_(static_cast<float>(scan.angle_min_rad));
  message.angle_increment_(static_cast<float>(scan.angle_step_rad));
  message.angle_max_(
      static_cast<float>(scan.angle_min_rad +
                         (static_cast<double>(scan.ranges_m.size()) - 1.0) * scan.angle_step_rad));
  message.range_max_(range_max_m);
  message.ranges_(scan.ranges_m);
  for (float& range_m : message.ranges_()) {
    if (range_m == kNoEcho) range_m = std::numeric_limits<float>::infinity();
  }
  return message;
}

}  // namespace topogeo::ros
