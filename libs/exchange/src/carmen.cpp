#include "topogeo/exchange/carmen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"

namespace topogeo::exchange {
namespace {

struct Reading {
  double angle_rad = 0.0;  ///< in the laser frame
  double range_m = 0.0;
};

std::vector<Reading> readings_of(const topomap::LocalMap& map) {
  const geometry::Pose2 T_laser_robot = geometry::inverse(map.T_robot_laser);
  std::vector<Reading> readings;
  readings.reserve(map.points.size());
  for (const topomap::ScanPoint& p : map.points) {
    const Eigen::Vector2d in_laser = T_laser_robot * Eigen::Vector2d(p.x_m, p.y_m);
    readings.push_back({geometry::atan2(in_laser.y(), in_laser.x()), in_laser.norm()});
  }
  return readings;
}

struct Beams {
  double first_rad = 0.0;
  double step_rad = 0.0;
  std::size_t count = 0;
};

/// Most lasers divide a turn by a whole number; a step measured from 32-bit points is rounded to
/// that when it is near.
double rounded_step(double step_rad) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const double steps = kTurn_rad / step_rad;
  const double whole = std::round(steps);
  return std::fabs(steps - whole) < 0.02 * whole / 100.0 ? kTurn_rad / whole : step_rad;
}

Beams beams_of(const std::vector<std::vector<Reading>>& stops) {
  std::vector<double> steps;
  double low_rad = std::numbers::pi;
  double high_rad = -std::numbers::pi;
  for (const std::vector<Reading>& readings : stops) {
    for (std::size_t i = 0; i < readings.size(); ++i) {
      low_rad = std::min(low_rad, readings[i].angle_rad);
      high_rad = std::max(high_rad, readings[i].angle_rad);
      if (i == 0) continue;
      const double step_rad = readings[i].angle_rad - readings[i - 1].angle_rad;
      if (step_rad > 0.0) steps.push_back(step_rad);
    }
  }
  if (steps.empty()) throw std::invalid_argument("the map has no scan points for a log");
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  Beams beams;
  beams.step_rad = rounded_step(*middle);
  beams.first_rad = low_rad;
  beams.count = static_cast<std::size_t>(std::lround((high_rad - low_rad) / beams.step_rad)) + 1;
  const std::size_t most = scan::CarmenLogReader::kMaxBeams;
  if (beams.count > most) {
    beams.count = most;
    beams.step_rad = (high_rad - low_rad) / static_cast<double>(most - 1);
  }
  // Half a turn, starting at -90 degrees, is the field of view of a FLASER line.
  const std::size_t half_turn =
      static_cast<std::size_t>(std::lround(std::numbers::pi / beams.step_rad));
  const double to_first = (beams.first_rad + std::numbers::pi / 2.0) / beams.step_rad;
  const bool within = to_first > -0.1 && high_rad < std::numbers::pi / 2.0 + 0.1 * beams.step_rad;
  if (within && half_turn >= 2 && std::fabs(to_first - std::round(to_first)) < 0.1) {
    beams.first_rad = -std::numbers::pi / 2.0;
    beams.count = half_turn + half_turn % 2 + 1;
    beams.step_rad = scan::flaser_angle_step_rad(beams.count);
  }
  beams.count = std::max<std::size_t>(beams.count, 2);
  return beams;
}

scan::Scan scan_of(const std::vector<Reading>& readings, const Beams& beams, StopScans& out) {
  scan::Scan scan;
  scan.angle_min_rad = beams.first_rad;
  scan.angle_step_rad = beams.step_rad;
  scan.ranges_m.assign(beams.count, scan::Scan::kNoReturn);
  for (const Reading& reading : readings) {
    const double steps = (reading.angle_rad - beams.first_rad) / beams.step_rad;
    const double nearest = std::clamp(std::round(steps), 0.0, static_cast<double>(beams.count - 1));
    out.angle_error_rad =
        std::max(out.angle_error_rad, std::fabs(steps - nearest) * beams.step_rad);
    float& range_m = scan.ranges_m[static_cast<std::size_t>(nearest)];
    if (range_m != scan::Scan::kNoReturn) ++out.lost_points;
    const auto here_m = static_cast<float>(reading.range_m);
    if (range_m == scan::Scan::kNoReturn || here_m < range_m) range_m = here_m;
  }
  return scan;
}

}  // namespace

StopScans stop_scans(const storage::MapDocument& document) {
  constexpr std::int64_t kBetweenDrives_ns = 60'000'000'000;
  std::vector<std::vector<Reading>> stops;
  for (const topomap::LocalMap& map : document.local_maps) stops.push_back(readings_of(map));
  const Beams beams = beams_of(stops);
  StopScans out;
  std::int64_t shift_ns = 0;
  std::int64_t last_ns = -1;
  for (const topomap::LocalMap& map : document.local_maps) {
    if (map.starts_drive) {
      shift_ns = map.stamp_ns > last_ns ? 0 : last_ns + kBetweenDrives_ns - map.stamp_ns;
    }
    if (map.points.empty()) continue;
    if (out.scans.empty()) out.T_robot_laser = map.T_robot_laser;
    scan::Scan scan = scan_of(stops[map.id], beams, out);
    scan.sequence = out.scans.size();
    scan.stamp_ns = map.stamp_ns + shift_ns;
    scan.T_odom_robot = map.T_odom_robot;
    last_ns = scan.stamp_ns;
    out.scans.push_back(std::move(scan));
  }
  return out;
}

}  // namespace topogeo::exchange
