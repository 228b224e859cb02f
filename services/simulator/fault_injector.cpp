#include "fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::simulator {
namespace {

// A disturbance as long as a report, ten times a second: some reports get through.
constexpr std::int64_t kGarbagePeriod_ns = 100'000'000;
constexpr std::size_t kGarbage_bytes = 24;

Device device_of(const msg::SimulatorCommand& message) {
  switch (message.fault()) {
    case msg::kSimulatedStuckScan:
    case msg::kSimulatedContaminated:
      return Device::kLaser;
    case msg::kSimulatedEcho:
    case msg::kSimulatedJoystick:
    case msg::kSimulatedEmergencyStop:
      return Device::kBase;
    default:
      return message.device() == msg::kSimulatedLaser ? Device::kLaser : Device::kBase;
  }
}

const char* name(msg::SimulatedFault kind) {
  switch (kind) {
    case msg::kSimulatedBadCrc:
      return "wrong checksums";
    case msg::kSimulatedTruncated:
      return "truncated telegrams";
    case msg::kSimulatedSilence:
      return "silence";
    case msg::kSimulatedGarbage:
      return "garbage";
    case msg::kSimulatedUnplug:
      return "no port";
    case msg::kSimulatedRestart:
      return "no power";
    case msg::kSimulatedStuckScan:
      return "the same scan";
    case msg::kSimulatedContaminated:
      return "a dirty window";
    case msg::kSimulatedEcho:
      return "echo";
    case msg::kSimulatedJoystick:
      return "joystick";
    case msg::kSimulatedEmergencyStop:
      return "emergency stop";
  }
  return "";
}

}  // namespace

Fault fault_from_msg(const msg::SimulatorCommand& message) {
  // An hour outlasts every test; no base of this kind reaches 3 m/s or 3 rad/s.
  constexpr double kLongest_s = 3600.0;
  constexpr double kFastest = 3.0;
  const auto check = [](bool ok, const char* field, const char* expected) {
    if (!ok) throw std::invalid_argument(std::string(field) + ": expected " + expected);
  };
  check(message.duration_s() > 0.0 && message.duration_s() <= kLongest_s, "duration_s",
        "(0, 3600] s");
  check(std::fabs(message.linear_mps()) <= kFastest, "linear_mps", "[-3, 3] m/s");
  check(std::fabs(message.angular_radps()) <= kFastest, "angular_radps", "[-3, 3] rad/s");
  return {message.fault(),
          device_of(message),
          message.duration_s(),
          {message.linear_mps(), message.angular_radps()}};
}

std::string describe(const Fault& fault) {
  return fmt::format("{} of the {} for {:g} s", name(fault.kind),
                     fault.device == Device::kLaser ? "laser" : "base", fault.duration_s);
}

void FaultInjector::begin(const Fault& fault) {
  const std::int64_t end_ns = devices_.now_ns() + std::llround(fault.duration_s * 1e9);
  const auto same = std::find_if(active_.begin(), active_.end(), [&](const Active& active) {
    return active.fault.kind == fault.kind && active.fault.device == fault.device;
  });
  if (same != active_.end()) {
    same->end_ns = std::max(same->end_ns, end_ns);
    return;
  }
  active_.push_back({fault, end_ns});
  set(fault, true);
}

void FaultInjector::tick() {
  const std::int64_t now_ns = devices_.now_ns();
  for (const Active& active : active_) {
    if (active.end_ns <= now_ns) {
      set(active.fault, false);
    } else if (active.fault.kind == msg::kSimulatedGarbage &&
               active.fault.device == Device::kBase && now_ns >= garbage_ns_) {
      garbage_ns_ = now_ns + kGarbagePeriod_ns;
      devices_.base().send_garbage(kGarbage_bytes, now_ns);
    } else if (active.fault.kind == msg::kSimulatedJoystick) {
      set(active.fault, true);  // the joystick keeps driving, whatever the host commands
    }
  }
  std::erase_if(active_, [now_ns](const Active& active) { return active.end_ns <= now_ns; });
}

void FaultInjector::set(const Fault& fault, bool on) {
  if (fault.kind == msg::kSimulatedUnplug) {
    DevicePort& port = devices_.port(fault.device);
    if (on) {
      port.unplug();
    } else {
      port.plug();
    }
  } else if (fault.device == Device::kLaser) {
    set_laser(fault, on);
  } else {
    set_base(fault, on);
  }
}

void FaultInjector::set_laser(const Fault& fault, bool on) {
  simulation::LaserEmulator& laser = devices_.laser();
  const std::int64_t now_ns = devices_.now_ns();
  switch (fault.kind) {
    case msg::kSimulatedBadCrc:
      return laser.set_fault(simulation::LaserFault::kBadChecksum, on);
    case msg::kSimulatedTruncated:
      return laser.set_fault(simulation::LaserFault::kTruncated, on);
    case msg::kSimulatedGarbage:
      return laser.set_fault(simulation::LaserFault::kGarbage, on);
    case msg::kSimulatedStuckScan:
      return laser.set_fault(simulation::LaserFault::kStuckScan, on);
    case msg::kSimulatedContaminated:
      return laser.set_contaminated(on);
    case msg::kSimulatedSilence:
      return on ? laser.fall_silent(now_ns) : laser.speak_again(now_ns);
    case msg::kSimulatedRestart:
      return on ? laser.switch_off() : laser.switch_on(now_ns);
    default:
      return;
  }
}

void FaultInjector::set_base(const Fault& fault, bool on) {
  simulation::BaseEmulator& base = devices_.base();
  const std::int64_t now_ns = devices_.now_ns();
  switch (fault.kind) {
    case msg::kSimulatedBadCrc:
      return base.set_fault(simulation::BaseFault::kCorrupted, on);
    case msg::kSimulatedTruncated:
      return base.set_fault(simulation::BaseFault::kTruncated, on);
    case msg::kSimulatedSilence:
      return base.set_fault(simulation::BaseFault::kSilent, on);
    case msg::kSimulatedRestart:
      return on ? base.switch_off(now_ns) : base.switch_on(now_ns);
    case msg::kSimulatedEcho:
      return base.set_fault(simulation::BaseFault::kEcho, on);
    case msg::kSimulatedJoystick:
      return base.take_joystick(on ? fault.velocity : simulation::Velocity{});
    case msg::kSimulatedEmergencyStop:
      return on ? base.press_emergency_stop() : base.release_emergency_stop();
    default:
      return;
  }
}

}  // namespace topogeo::simulator
