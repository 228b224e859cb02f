// Makes the faults that commands ask for, and ends them when their time is over.
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
  double duration_s = 1.0;          ///< in the world; (0, 3600]
  simulation::Velocity velocity{};  ///< of the joystick
};

/// Throws std::invalid_argument naming the field that is out of range.
Fault fault_from_msg(const msg::SimulatorCommand& message);
/// "silence of the laser for 2 s", for people.
std::string describe(const Fault& fault);

class FaultInjector {
 public:
  /// `devices` outlives it.
  explicit FaultInjector(SimulatedDevices& devices) : devices_(devices) {}

  /// Begins now; one of the same kind and device that goes on already lasts longer instead.
  void begin(const Fault& fault);
  /// Ends what is over; to be called often.
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
  void strike(simulation::PlsFault fault, bool on);

  SimulatedDevices& devices_;
  std::vector<Active> active_;
  std::int64_t garbage_ns_ = 0;  // when the base sends some more
};

}  // namespace topogeo::simulator
