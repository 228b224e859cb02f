// Injects the faults that commands ask for, and ends them in time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/msg/simulation.h"

#include "simulated_devices.hpp"

namespace topogeo::simulator {

struct Fault {
  msg::SimulatedFault kind = msg::kSimulatedSilence;
  Device device = Device::kLaser;
  double duration_s = 1.0;          ///< time in the world; (0, 3600]
  simulation::Velocity velocity{};  ///< of the joystick
};

/// Throws std::invalid_argument naming the field that is out of range.
Fault fault_from_msg(const msg::SimulatorCommand& message);
/// "silence of the laser for 2 s", for people.
std::string describe(const Fault& fault);

class FaultInjector {
 public:
  /// `devices` must outlive it.
  explicit FaultInjector(SimulatedDevices& devices) : devices_(devices) {}

  /// Begins a fault now; an active one of the same kind and device is prolonged instead.
  void begin(const Fault& fault);
  /// Ends faults whose time is over; call it often.
  void tick();
  [[nodiscard]] std::size_t active() const { return active_.size(); }

 private:
  struct Active {
    Fault fault;
    std::int64_t end_ns = 0;
  };
  void set(const Fault& fault, bool on);
  void set_laser(const Fault& fault, bool on);
  void set_base(const Fault& fault, bool on);

  SimulatedDevices& devices_;
  std::vector<Active> active_;
  std::int64_t garbage_ns_ = 0;  // when the base sends the next garbage
};

}  // namespace topogeo::simulator
