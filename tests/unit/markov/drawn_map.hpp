// Worlds of the Markov tests: cells drawn in ASCII, and a room whose walls are known as lines, so
// that true readings are independent of the cells under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/markov/obstacle_cells.hpp"
#include "topogeo/markov/range_sensor.hpp"

namespace topogeo::markov::test {

inline constexpr double kQuarter_rad = 0.5 * std::numbers::pi;

/// The top line is the highest row; '#' is an obstacle. Cell (0, 0) is at the lower left, its outer
/// corner at the origin of the map.
inline ObstacleCells drawn(const std::vector<std::string>& lines, double cell_m = 0.1,
                           int cells_a_side = 1) {
  std::vector<std::uint8_t> cells;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    for (const char c : *line) cells.push_back(c == '#' ? 1 : 0);
  }
  return ObstacleCells{{.width = static_cast<int>(lines.front().size()),
                        .height = static_cast<int>(lines.size()),
                        .resolution_m = cell_m,
                        .occupied = cells},
                       cells_a_side};
}

inline ObstacleCells open_space(int width, int height) {
  return drawn(std::vector<std::string>(static_cast<std::size_t>(height),
                                        std::string(static_cast<std::size_t>(width), '.')));
}

/// A rectangle of free space from (0.1, 0.1) m on, with a wall of one cell around it.
struct Room {
  int cells_x;
  int cells_y;

  [[nodiscard]] ObstacleCells cells() const {
    const std::string wall(static_cast<std::size_t>(cells_x + 2), '#');
    std::string row(static_cast<std::size_t>(cells_x + 2), '.');
    row.front() = row.back() = '#';
    std::vector<std::string> lines(static_cast<std::size_t>(cells_y + 2), row);
    lines.front() = wall;
    lines.back() = wall;
    return drawn(lines);
  }

  /// Distance from a point in the room to its walls along a bearing.
  [[nodiscard]] double ray_m(const Eigen::Vector2d& from_m, double bearing_rad) const {
    const double along_x = std::cos(bearing_rad);
    const double along_y = std::sin(bearing_rad);
    double range_m = std::numeric_limits<double>::infinity();
    if (along_x > 0.0) range_m = std::min(range_m, (0.1 + 0.1 * cells_x - from_m.x()) / along_x);
    if (along_x < 0.0) range_m = std::min(range_m, (0.1 - from_m.x()) / along_x);
    if (along_y > 0.0) range_m = std::min(range_m, (0.1 + 0.1 * cells_y - from_m.y()) / along_y);
    if (along_y < 0.0) range_m = std::min(range_m, (0.1 - from_m.y()) / along_y);
    return range_m;
  }

  /// The shortest of 201 rays across each cone.
  [[nodiscard]] std::vector<float> measured(const geometry::Pose2& T_map_robot,
                                            const std::vector<RangeSensor>& sensors) const {
    std::vector<float> ranges_m;
    for (const RangeSensor& sensor : sensors) {
      const geometry::Pose2 T_map_sensor = T_map_robot * sensor.T_robot_sensor;
      double range_m = std::numeric_limits<double>::infinity();
      for (int i = -100; i <= 100; ++i) {
        const double bearing_rad = T_map_sensor.theta_rad + 0.01 * i * sensor.half_cone_rad;
        range_m = std::min(range_m, ray_m(T_map_sensor.position_m(), bearing_rad));
      }
      ranges_m.push_back(static_cast<float>(range_m));
    }
    return ranges_m;
  }
};

inline std::vector<RangeSensor> macondo_ring() {
  std::vector<RangeSensor> sensors;
  for (const devices::SonarMount& mount : devices::macondo_sonars()) {
    sensors.push_back({mount.T_robot_sonar, mount.half_cone_rad});
  }
  return sensors;
}

}  // namespace topogeo::markov::test
