#include "topogeo/simulation/pioneer_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

namespace topogeo::simulation {
namespace {

constexpr double kPioneerTrack_m = 0.33;
constexpr double kFineTicksPerM = 100'000.0;
constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr std::uint16_t kNoEcho = 5000;
constexpr std::uint8_t kLastSync = 2;
/// A ring of eight fires one sonar every 40 ms.
constexpr std::size_t kEchoesPerReport = 3;

TwoWheelEmulatorSettings pioneer_wheels(const PioneerEmulatorSettings& settings) {
  return {.line = settings.line,
          .ticks_per_m = kFineTicksPerM,
          .track_m = kPioneerTrack_m,
          .report_ns = settings.report_ns,
          .seed = settings.seed};
}

std::uint16_t position(double units) {
  constexpr long kMask = (1L << devices::kPioneerPositionBits) - 1;
  return static_cast<std::uint16_t>(std::lround(units) & kMask);
}

}  // namespace

PioneerEmulator::PioneerEmulator(const PioneerEmulatorSettings& settings, std::int64_t now_ns)
    : TwoWheelEmulator(pioneer_wheels(settings)), pioneer_(settings) {
  ranges_.fill(kNoEcho);
  switch_on(now_ns);
}

void PioneerEmulator::forget() {
  reader_.clear();
  last_ticks_ = {};
  last_heading_rad_ = 0.0;
  close();
}

void PioneerEmulator::close() {
  link_ = Link::kWaiting;
  next_sync_ = 0;
  motors_ = sonars_fire_ = waits_ = false;
  deceleration_mmps2_ = 0;
  setpoint_ = {};
  want({});
}

void PioneerEmulator::stand_still(std::int64_t duration_ns) {
  heard_ns_ += duration_ns;
  TwoWheelEmulator::stand_still(duration_ns);
}

void PioneerEmulator::obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  reader_.push(bytes);
  while (const auto packet = reader_.next()) {
    const auto order = devices::pioneer_order(*packet);
    if (!order) continue;
    if (losses_ > 0 && order->command == lost_command_) {
      --losses_;
    } else if (link_ == Link::kWaiting) {
      synchronize(order->command, now_ns);
    } else {
      obey_order(*order, now_ns);
    }
  }
}

void PioneerEmulator::synchronize(std::uint8_t step, std::int64_t now_ns) {
  if (step != 0 && step != next_sync_) return;
  devices::PioneerPacket answer{{step}};
  if (step == kLastSync) {
    constexpr std::string_view kNames("emulator\0Pioneer\0p3dx-sh\0", 25);
    for (const char letter : kNames) answer.payload.push_back(static_cast<std::uint8_t>(letter));
    link_ = Link::kConnected;
    heard_ns_ = now_ns;
  }
  next_sync_ = static_cast<std::uint8_t>(step + 1);
  say(devices::to_bytes(answer), now_ns);
}

void PioneerEmulator::obey_order(const devices::PioneerOrder& order, std::int64_t now_ns) {
  namespace command = devices::pioneer_command;
  const int value = order.value.value_or(0);
  heard_ns_ = now_ns;
  waits_ = false;
  switch (order.command) {
    case command::kOpen:
      if (link_ == Link::kConnected) T_server_robot_ = {};
      link_ = Link::kOpen;
      break;
    case command::kClose:
      return close();
    case command::kEnable:
      motors_ = value != 0 && !stop_pressed_;
      break;
    case command::kSpeed:
      setpoint_.linear_m_per_s = 1e-3 * value;
      break;
    case command::kTurn:
      setpoint_.angular_rad_per_s = kRadPerDegree * value;
      break;
    case command::kSonar:
      sonars_fire_ = value != 0;
      break;
    case command::kSetAcceleration:
      if (value < 0) deceleration_mmps2_ = -value;
      break;
    default:
      break;
  }
  drive();
}

void PioneerEmulator::drive() {
  const double side_mps = 0.5 * kPioneerTrack_m * setpoint_.angular_rad_per_s;
  want({setpoint_.linear_m_per_s - side_mps, setpoint_.linear_m_per_s + side_mps});
}

void PioneerEmulator::tick(std::int64_t now_ns) {
  if (link_ != Link::kWaiting && now_ns >= heard_ns_ + pioneer_.watchdog_ns) {
    waits_ = true;
    want({});
  }
  TwoWheelEmulator::tick(now_ns);
}

std::int64_t PioneerEmulator::due_ns() const {
  const std::int64_t due_ns = TwoWheelEmulator::due_ns();
  if (link_ == Link::kWaiting || waits_) return due_ns;
  return std::min(due_ns, heard_ns_ + pioneer_.watchdog_ns);
}

void PioneerEmulator::follow_wheels() {
  const std::array<std::int64_t, 2> now{ticks(0), ticks(1)};
  const double forward_m =
      0.5 * static_cast<double>(now[0] - last_ticks_[0] + now[1] - last_ticks_[1]) / kFineTicksPerM;
  const geometry::Pose2 half{0.0, 0.0, 0.5 * (heading_rad() - last_heading_rad_)};
  T_server_robot_ = T_server_robot_ * half * geometry::Pose2{forward_m, 0.0, 0.0} * half;
  last_ticks_ = now;
  last_heading_rad_ = heading_rad();
}

void PioneerEmulator::add_echoes() {
  seen_.echoes.clear();
  if (!sonars_fire_) return;
  for (std::size_t i = 0; i < std::min(kEchoesPerReport, pioneer_.sonars); ++i) {
    seen_.echoes.push_back({static_cast<std::uint8_t>(next_sonar_), ranges_[next_sonar_]});
    next_sonar_ = (next_sonar_ + 1) % pioneer_.sonars;
  }
}

void PioneerEmulator::report(std::int64_t now_ns) {
  follow_wheels();
  if (!open()) return;
  constexpr double kUnitsPerVolt = 10.0;
  constexpr unsigned kStopButton = 0x20;
  const double units_per_rad = pioneer_.units.units_per_turn / (2.0 * std::numbers::pi);
  const geometry::Velocity wheels = commanded_velocity();
  seen_.moves = wheels.linear_m_per_s != 0.0 || wheels.angular_rad_per_s != 0.0;
  seen_.x = position(T_server_robot_.x_m * pioneer_.units.units_per_m);
  seen_.y = position(T_server_robot_.y_m * pioneer_.units.units_per_m);
  seen_.heading = static_cast<std::int16_t>(
      std::lround(units_per_rad * geometry::wrap_angle(T_server_robot_.theta_rad)));
  seen_.battery_dv = static_cast<std::uint8_t>(std::lround(kUnitsPerVolt * pioneer_.battery_v));
  seen_.flags = static_cast<std::uint16_t>((motors_ ? devices::kPioneerMotors : 0U) |
                                           (stop_pressed_ ? kStopButton : 0U));
  add_echoes();
  say_report(devices::to_bytes(devices::to_packet(seen_)), now_ns);
}

/// Five bumpers in front, five behind. Bits of `pressed` count counter-clockwise from straight
/// ahead, 22.5 degrees each.
void PioneerEmulator::press_bumpers(std::uint16_t pressed, std::int64_t /*now_ns*/) {
  constexpr unsigned kAhead = 0xF00F;
  constexpr unsigned kFrontCentre = 0x0800;
  constexpr unsigned kRearCentre = 0x0008;
  constexpr unsigned kStalls = devices::kPioneerLeftStall | devices::kPioneerRightStall;
  const unsigned stalls = seen_.stalls & kStalls;
  seen_.stalls = static_cast<std::uint16_t>(stalls | ((pressed & kAhead) != 0 ? kFrontCentre : 0U) |
                                            ((pressed & ~kAhead) != 0 ? kRearCentre : 0U));
}

void PioneerEmulator::press_emergency_stop() {
  stop_pressed_ = true;
  motors_ = false;
}

}  // namespace topogeo::simulation
