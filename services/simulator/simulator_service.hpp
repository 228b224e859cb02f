// A simulated robot on DDS and serial ports: paces the world, publishes the robot's true pose and
// the readings of its body sensors, and takes fault commands.
#pragma once

#include <chrono>
#include <cstdint>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/simulation.h"
#include "topogeo/service/body_sensor_publisher.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/simulation/simulated_body_sensors.hpp"

#include "fault_injector.hpp"
#include "simulated_devices.hpp"

namespace topogeo::simulator {

struct SimulatorOptions {
  DeviceOptions devices;
  double time_factor = 1.0;  ///< world time over real time, > 0
};

/// The world and its devices, on the world's clock. They outlive a service that rejoins its peers:
/// the robot stays in place, and its ports stay open.
struct SimulatedWorld {
  using Clock = std::chrono::steady_clock;

  /// Throws like SimulatedDevices.
  SimulatedWorld(world::World world, const SimulatorOptions& options);
  SimulatedWorld(const SimulatedWorld&) = delete;
  SimulatedWorld& operator=(const SimulatedWorld&) = delete;

  SimulatorOptions options;
  SimulatedDevices devices;
  FaultInjector faults{devices};
  Clock::time_point start;      ///< real time at world time 0
  std::int64_t start_stamp_ns;  ///< the same since the epoch
};

/// Lives in the loop of its service. The sonars, infrared and tactile sensors of a B21 have a bus
/// of their own, apart from the line of the base: their readings are published directly.
class SimulatorService {
 public:
  /// Both arguments must outlive it.
  SimulatorService(service::Service& service, SimulatedWorld& world);

 private:
  void tick();
  void publish_truth();
  void publish_state();
  void on_command(const msg::SimulatorCommand& command);
  /// The stamp of the current world time.
  [[nodiscard]] std::int64_t stamp_ns() const;

  service::Service& service_;
  SimulatedWorld& world_;
  SimulatedDevices& devices_;
  messaging::Writer<msg::GroundTruth> truth_;
  simulation::SimulatedBodySensors body_sensors_;
  service::BodySensorPublisher body_;
  std::int64_t truth_due_ns_ = 0;  // world time, like the next two
  std::int64_t body_due_ns_ = 0;
  std::int64_t state_due_ns_ = 0;
  std::uint64_t truths_ = 0;
};

}  // namespace topogeo::simulator
