#include "topogeo/devices/sonar_ring.hpp"

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::devices {

std::vector<SonarMount> macondo_sonars() {
  constexpr double kAhead_m = 0.24;
  constexpr double kBeside_m = 0.1;
  constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
  return {{.T_robot_sonar = {kAhead_m, kBeside_m, 0.0}},
          {.T_robot_sonar = {kAhead_m, -kBeside_m, 0.0}},
          {.T_robot_sonar = {kBeside_m, kAhead_m, kQuarter_rad}},
          {.T_robot_sonar = {-kBeside_m, kAhead_m, kQuarter_rad}},
          {.T_robot_sonar = {kBeside_m, -kAhead_m, -kQuarter_rad}},
          {.T_robot_sonar = {-kBeside_m, -kAhead_m, -kQuarter_rad}}};
}

std::vector<SonarMount> b21_sonars() {
  constexpr int kSonars = 24;
  std::vector<SonarMount> mounts;
  mounts.reserve(kSonars);
  for (int i = 0; i < kSonars; ++i) {
    const double bearing_rad =
        geometry::wrap_angle((static_cast<double>(i) + 0.5) * 2.0 * std::numbers::pi / kSonars);
    const geometry::SinCos direction = geometry::sincos(bearing_rad);
    mounts.push_back({.T_robot_sonar = {kB21Radius_m * direction.cos, kB21Radius_m * direction.sin,
                                        bearing_rad}});
  }
  return mounts;
}

}  // namespace topogeo::devices
