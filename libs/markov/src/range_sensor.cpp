#include "topogeo/markov/range_sensor.hpp"

#include <cstddef>
#include <stdexcept>
#include <string>

namespace topogeo::markov {
namespace {

std::size_t checked(int every) {
  if (every >= 1) return static_cast<std::size_t>(every);
  throw std::invalid_argument("every " + std::to_string(every) + "-th beam: must be at least 1");
}

}  // namespace

std::vector<RangeSensor> laser_sensors(const geometry::Pose2& T_robot_laser, const scan::Scan& scan,
                                       int every) {
  const std::size_t step = checked(every);
  std::vector<RangeSensor> sensors;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); beam += step) {
    const double angle_rad = scan.angle_min_rad + static_cast<double>(beam) * scan.angle_step_rad;
    sensors.push_back({.T_robot_sensor = T_robot_laser * geometry::Pose2{0.0, 0.0, angle_rad}});
  }
  return sensors;
}

std::vector<float> laser_ranges(const scan::Scan& scan, int every) {
  const std::size_t step = checked(every);
  std::vector<float> ranges_m;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); beam += step) {
    ranges_m.push_back(scan.ranges_m[beam]);
  }
  return ranges_m;
}

}  // namespace topogeo::markov
