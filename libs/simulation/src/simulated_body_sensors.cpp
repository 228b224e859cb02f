#include "topogeo/simulation/simulated_body_sensors.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace topogeo::simulation {
namespace {

/// The panels within `touch_m` of a surface: each is a part of the rim, the first one left of
/// ahead.
template <std::size_t kPanels>
std::bitset<kPanels> touched(const world::World& scene, const geometry::Pose2& T_world_robot,
                             double touch_m) {
  std::bitset<kPanels> pressed;
  constexpr double kPanel_rad = 2.0 * std::numbers::pi / static_cast<double>(kPanels);
  for (std::size_t i = 0; i < kPanels; ++i) {
    const double bearing_rad = (static_cast<double>(i) + 0.5) * kPanel_rad;
    const geometry::Pose2 T_robot_panel{0.0, 0.0, geometry::wrap_angle(bearing_rad)};
    const Echo nearest = echo(scene, T_world_robot * T_robot_panel, 0.5 * kPanel_rad,
                              devices::kB21Radius_m + touch_m);
    pressed[i] = std::isfinite(nearest.range_m);
  }
  return pressed;
}

}  // namespace

SimulatedBodySensors::SimulatedBodySensors(Scene scene, Pose pose, const BodySensorNoise& noise)
    : SimulatedBodySensors(std::move(scene), std::move(pose), Sonars(), noise) {}

SimulatedBodySensors::SimulatedBodySensors(Scene scene, Pose pose, Sonars sonars,
                                           const BodySensorNoise& noise)
    : scene_(std::move(scene)),
      pose_(std::move(pose)),
      sonars_(std::move(sonars)),
      noise_(noise),
      random_(noise.seed) {
  if (!scene_ || !pose_ || !(noise.sonar_sigma_m >= 0.0) || !(noise.infrared_sigma_m >= 0.0) ||
      !(noise.touch_m >= 0.0)) {
    throw std::invalid_argument(
        "simulated body sensors need a world, a pose, and noise of at least 0");
  }
}

std::optional<devices::BodyReadings> SimulatedBodySensors::read(std::int64_t now_ns) {
  const world::World scene = scene_(now_ns);
  const geometry::Pose2 T_world_robot = pose_(now_ns);
  devices::BodyReadings readings;
  readings.stamp_ns = now_ns;
  readings.sonar_m =
      sonars_ ? sonars_()
              : ranges(devices::b21_sonar_ring(), noise_.sonar_sigma_m, scene, T_world_robot);
  readings.body_infrared_m =
      ranges(devices::b21_body_infrared(), noise_.infrared_sigma_m, scene, T_world_robot);
  readings.base_infrared_m =
      ranges(devices::b21_base_infrared(), noise_.infrared_sigma_m, scene, T_world_robot);
  readings.body_pressed = touched<devices::kB21BodyPanels>(scene, T_world_robot, noise_.touch_m);
  readings.base_pressed = touched<devices::kB21BasePanels>(scene, T_world_robot, noise_.touch_m);
  return readings;
}

std::vector<float> SimulatedBodySensors::ranges(const devices::RangeRing& ring, double sigma_m,
                                                const world::World& scene,
                                                const geometry::Pose2& T_world_robot) {
  SonarNoise noise;
  noise.sigma_m = sigma_m;
  noise.range_min_m = ring.range_min_m;
  noise.range_max_m = ring.range_max_m;
  std::vector<Echo> echoes;
  for (const devices::SonarMount& mount : ring.mounts) {
    echoes.push_back(
        echo(scene, T_world_robot * mount.T_robot_sonar, mount.half_cone_rad, ring.range_max_m));
  }
  return measure(echoes, noise, random_);
}

}  // namespace topogeo::simulation
