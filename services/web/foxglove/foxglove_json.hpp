// Parts of Foxglove's well-known types as JSON.
#pragma once

#include <cmath>
#include <cstdint>

#include "server/json_values.hpp"

namespace topogeo::web {

constexpr const char* kMapFrame = "map";

/// Since 1970, or since the epoch of the robot's data source.
inline Json foxglove_time(std::int64_t stamp_ns) {
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  const std::int64_t fraction_ns = ((stamp_ns % kNanoseconds) + kNanoseconds) % kNanoseconds;
  return {{"sec", (stamp_ns - fraction_ns) / kNanoseconds}, {"nsec", fraction_ns}};
}

/// Metres.
inline Json foxglove_vector(double x, double y, double z = 0.0) {
  return {{"x", x}, {"y", y}, {"z", z}};
}

/// About z, counter-clockwise.
inline Json foxglove_rotation(double theta_rad) {
  return {
      {"x", 0.0}, {"y", 0.0}, {"z", std::sin(theta_rad / 2.0)}, {"w", std::cos(theta_rad / 2.0)}};
}

inline Json foxglove_pose(double x_m, double y_m, double theta_rad = 0.0, double z_m = 0.0) {
  return {{"position", foxglove_vector(x_m, y_m, z_m)},
          {"orientation", foxglove_rotation(theta_rad)}};
}

}  // namespace topogeo::web
