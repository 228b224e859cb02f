#include "topogeo/devices/sonar_ring.hpp"

#include <array>

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

std::vector<SonarMount> pioneer_sonars() {
  struct Sonar {
    double x_m;
    double y_m;
    double bearing_deg;
  };
  constexpr std::array<Sonar, 16> kSonars{{{0.069, 0.136, 90.0},
                                           {0.114, 0.119, 50.0},
                                           {0.148, 0.078, 30.0},
                                           {0.166, 0.027, 10.0},
                                           {0.166, -0.027, -10.0},
                                           {0.148, -0.078, -30.0},
                                           {0.114, -0.119, -50.0},
                                           {0.069, -0.136, -90.0},
                                           {-0.157, -0.136, -90.0},
                                           {-0.203, -0.119, -130.0},
                                           {-0.237, -0.078, -150.0},
                                           {-0.255, -0.027, -170.0},
                                           {-0.255, 0.027, 170.0},
                                           {-0.237, 0.078, 150.0},
                                           {-0.203, 0.119, 130.0},
                                           {-0.157, 0.136, 90.0}}};
  std::vector<SonarMount> mounts;
  mounts.reserve(kSonars.size());
  for (const Sonar& sonar : kSonars) {
    mounts.push_back(
        {.T_robot_sonar = {sonar.x_m, sonar.y_m, sonar.bearing_deg * std::numbers::pi / 180.0}});
  }
  return mounts;
}

}  // namespace topogeo::devices
