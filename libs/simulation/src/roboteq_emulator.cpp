#include "topogeo/simulation/roboteq_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace topogeo::simulation {
namespace {

constexpr std::int64_t kRoboteqMs_ns = 1'000'000;
constexpr std::int32_t kStoredWatchdog_ms = 1000;
constexpr std::size_t kLongestOrder = 64;

TwoWheelEmulatorSettings roboteq_wheels(const RoboteqEmulatorSettings& settings) {
  return {.line = settings.line,
          .ticks_per_m = settings.wheels.ticks_per_m,
          .track_m = settings.wheels.track_m,
          .seed = settings.seed,
          .corrupted_bits = 7};
}

std::vector<std::uint8_t> roboteq_bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

}  // namespace

RoboteqEmulator::RoboteqEmulator(const RoboteqEmulatorSettings& settings, std::int64_t now_ns)
    : TwoWheelEmulator(roboteq_wheels(settings)), roboteq_(settings) {
  switch_on(now_ns);
}

void RoboteqEmulator::forget() {
  line_.clear();
  echoes_ = roboteq_.echoes;
  watchdog_ms_ = kStoredWatchdog_ms;
  rpm_ = {};
  expired_ = true;
}

void RoboteqEmulator::stand_still(std::int64_t duration_ns) {
  commanded_ns_ += duration_ns;
  TwoWheelEmulator::stand_still(duration_ns);
}

std::size_t RoboteqEmulator::channel(std::size_t wheel) const {
  return wheel == 0 ? roboteq_.wheels.left_channel - 1U : 2U - roboteq_.wheels.left_channel;
}

int RoboteqEmulator::direction(std::size_t wheel) const {
  return (wheel == 0 ? roboteq_.wheels.left_reversed : roboteq_.wheels.right_reversed) ? -1 : 1;
}

void RoboteqEmulator::obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  for (const std::uint8_t byte : bytes) {
    if (echoes_) say({byte}, now_ns);
    if (byte == '\r') {
      obey_line(std::exchange(line_, {}), now_ns);
    } else if (line_.size() < kLongestOrder) {
      line_ += static_cast<char>(byte);
    }
  }
}

void RoboteqEmulator::obey_line(const std::string& line, std::int64_t now_ns) {
  if (line.empty()) return;
  const auto order = devices::roboteq_order(line);
  if (order && (order->kind == '?' || order->kind == '~')) return answer(*order, now_ns);
  const bool known = order && (order->kind == '!' ? run(*order, now_ns) : set(*order));
  say(roboteq_bytes(known ? "+\r" : "-\r"), now_ns);
}

bool RoboteqEmulator::run(const devices::RoboteqOrder& order, std::int64_t now_ns) {
  const std::vector<std::int32_t>& arguments = order.arguments;
  const bool speed = order.name == "S" || order.name == "G";
  if (order.name != "MG" && (!speed || arguments.size() != 2)) return false;
  if (speed && (arguments[0] < 1 || arguments[0] > 2)) return false;
  commanded_ns_ = now_ns;
  expired_ = false;
  if (speed) {
    constexpr double kFull = 1000.0;
    const double unit = order.name == "S" ? 1.0 : roboteq_.wheels.full_rpm / kFull;
    rpm_.at(static_cast<std::size_t>(arguments[0] - 1)) = unit * arguments[1];
  }
  drive();
  return true;
}

bool RoboteqEmulator::set(const devices::RoboteqOrder& order) {
  if (order.arguments.size() != 1) return false;
  if (order.name == "ECHOF") {
    echoes_ = order.arguments[0] == 0;
  } else if (order.name == "RWD") {
    if (roboteq_.takes_watchdog) watchdog_ms_ = order.arguments[0];
  } else {
    return false;
  }
  return true;
}

void RoboteqEmulator::answer(const devices::RoboteqOrder& order, std::int64_t now_ns) {
  devices::RoboteqAnswer reply{order.name, {}};
  if (order.name == "C") {
    reply.numbers = {0, 0};
    for (std::size_t i = 0; i < 2; ++i) {
      reply.numbers[channel(i)] = static_cast<std::int32_t>(direction(i) * ticks(i));
    }
    return say_report(devices::to_bytes(reply), now_ns);
  }
  if (order.name == "RWD") {
    reply.numbers = {watchdog_ms_};
  } else if (order.name == "FF") {
    reply.numbers = {(overheats_ ? 1 : 0) | (emergency_stop_ ? devices::kRoboteqEmergencyStop : 0)};
  } else if (order.name == "V") {
    constexpr double kUnitsPerVolt = 10.0;
    const auto battery = static_cast<std::int32_t>(std::lround(kUnitsPerVolt * roboteq_.battery_v));
    reply.numbers = {135, battery, 4953};
  } else {
    return say(roboteq_bytes("-\r"), now_ns);
  }
  say(devices::to_bytes(reply), now_ns);
}

void RoboteqEmulator::drive() {
  constexpr double kRoboteqSecondsPerMinute = 60.0;
  std::array<double, 2> wheels_mps{};
  for (std::size_t i = 0; i < 2; ++i) {
    wheels_mps[i] = direction(i) * rpm_[channel(i)] / kRoboteqSecondsPerMinute /
                    roboteq_.wheels.motor_turns_per_m;
  }
  want(wheels_mps);
}

std::int64_t RoboteqEmulator::expires_ns() const {
  return commanded_ns_ + watchdog_ms_ * kRoboteqMs_ns;
}

void RoboteqEmulator::tick(std::int64_t now_ns) {
  if (!expired_ && now_ns >= expires_ns()) {
    expired_ = true;
    want({});
  }
  TwoWheelEmulator::tick(now_ns);
}

std::int64_t RoboteqEmulator::due_ns() const {
  const std::int64_t due_ns = TwoWheelEmulator::due_ns();
  return expired_ ? due_ns : std::min(due_ns, expires_ns());
}

}  // namespace topogeo::simulation
