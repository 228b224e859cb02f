// The sensors in the panels of an emulated B21: echoes and touches in a world.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/devices/body_sensors.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/sonar.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

struct BodySensorNoise {
  double sonar_sigma_m = 0.02;     ///< standard deviation; >= 0
  double infrared_sigma_m = 0.05;  ///< the same; no source has a figure, it is called rough
  double touch_m = 0.01;           ///< a smaller distance to a panel is a touch; >= 0
  std::uint64_t seed = 1;
};

class SimulatedBodySensors final : public devices::BodySensors {
 public:
  /// The surroundings and the robot's pose, T_world_robot, at a time.
  using Scene = std::function<world::World(std::int64_t now_ns)>;
  using Pose = std::function<geometry::Pose2(std::int64_t now_ns)>;
  /// Readings of sonars other than the ring's, for BodyReadings::sonar_m.
  using Sonars = std::function<std::vector<float>()>;

  /// Throws std::invalid_argument for noise out of range and missing functions.
  SimulatedBodySensors(Scene scene, Pose pose, const BodySensorNoise& noise = {});
  /// Uses the sonars of the robot.
  SimulatedBodySensors(Scene scene, Pose pose, Sonars sonars, const BodySensorNoise& noise = {});

  std::optional<devices::BodyReadings> read(std::int64_t now_ns) override;
  [[nodiscard]] std::string fault() const override { return {}; }

 private:
  [[nodiscard]] std::vector<float> ranges(const devices::RangeRing& ring, double sigma_m,
                                          const world::World& scene,
                                          const geometry::Pose2& T_world_robot);

  Scene scene_;
  Pose pose_;
  Sonars sonars_;  // empty: the ring's sonars
  BodySensorNoise noise_;
  support::Random random_;
};

}  // namespace topogeo::simulation
