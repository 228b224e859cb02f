#include "topogeo/simulation/ydlidar_emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "topogeo/devices/rplidar_protocol.hpp"
#include "topogeo/devices/ydlidar_packet.hpp"

namespace topogeo::simulation {
namespace {

constexpr std::size_t kMostSamples = 40;
constexpr std::uint8_t kYdRequestStart = 0xA5;

std::uint16_t yd_sixty_fourths(double angle_deg) {
  return static_cast<std::uint16_t>(std::lround(64.0 * angle_deg) % devices::kYdTurnQ6);
}

}  // namespace

YdLidarEmulator::YdLidarEmulator(const YdLidarEmulatorSettings& settings, Ranges ranges,
                                 std::int64_t now_ns)
    : TurningEmulator(settings.line, {settings.turns_hz, settings.samples_hz, settings.wobble},
                      settings.range_max_m, settings.seed, std::move(ranges)),
      settings_(settings) {
  if (!settings.asked) schedule(now_ns);
}

void YdLidarEmulator::receive(std::span<const std::uint8_t> bytes,
                              const devices::LineSettings& host, std::int64_t now_ns) {
  tick(now_ns);
  if (!settings_.asked || off_ || is_silent() || host != settings_.line || now_ns < ready_ns_) {
    request_.clear();
    return;
  }
  for (const std::uint8_t byte : bytes) {
    if (request_.empty() && byte != kYdRequestStart) continue;
    request_.push_back(byte);
    if (request_.size() == 2) obey(std::exchange(request_, {})[1], now_ns);
  }
}

void YdLidarEmulator::obey(std::uint8_t command, std::int64_t now_ns) {
  const auto reply = [&](const devices::RpDescriptor& descriptor,
                         std::span<const std::uint8_t> data) {
    std::vector<std::uint8_t> bytes = devices::rp_bytes(descriptor);
    bytes.insert(bytes.end(), data.begin(), data.end());
    answer(std::move(bytes), now_ns + settings_.answer_ns);
  };
  switch (command) {
    case devices::yd_command::kStop:
      return schedule(kNever_ns);
    case devices::yd_command::kGetInfo: {
      const std::array<std::uint8_t, devices::kYdInfo_bytes> info{settings_.model, 71, 1, 2};
      return reply({devices::kYdInfo_bytes, false, devices::yd_answer::kInfo}, info);
    }
    case devices::yd_command::kGetHealth: {
      const std::array<std::uint8_t, devices::kYdHealth_bytes> health{settings_.health, 0, 0};
      return reply({devices::kYdHealth_bytes, false, devices::yd_answer::kHealth}, health);
    }
    case devices::yd_command::kScan:
      reply({5, true, devices::yd_answer::kScan}, {});
      return schedule(now_ns + 2 * settings_.answer_ns);
    default:
      return;
  }
}

void YdLidarEmulator::switch_off() {
  TurningEmulator::switch_off();
  off_ = true;
  request_.clear();
}

void YdLidarEmulator::switch_on(std::int64_t now_ns) {
  TurningEmulator::switch_off();
  off_ = false;
  turned_ = true;
  angle_deg_ = 0.0;
  ready_ns_ = now_ns + settings_.start_up_ns;
  if (!settings_.asked) schedule(ready_ns_);
}

void YdLidarEmulator::send_packet() {
  const double mean_step_deg = kTurn_deg * settings_.turns_hz / settings_.samples_hz;
  const auto until_turn = static_cast<std::size_t>(
      std::max(1.0, std::ceil((kTurn_deg - angle_deg_) / mean_step_deg - 1.0)));
  const std::size_t count = turned_ ? 1 : std::min(kMostSamples, until_turn);
  const double turns_hz = turn_motor(count);
  const double step_deg = kTurn_deg * turns_hz / settings_.samples_hz;
  const std::vector<double> readings_mm =
      settings_.triangulates
          ? measure_aside_mm(angle_deg_, step_deg, count,
                             {devices::yd_correction_deg, [](double range_mm) { return range_mm; }})
          : measure_mm(angle_deg_, step_deg, count);
  devices::YdPacket packet;
  packet.starts_turn = std::exchange(turned_, false);
  if (packet.starts_turn && settings_.reports_frequency) {
    packet.turns_dhz = static_cast<std::uint8_t>(std::lround(10.0 * turns_hz));
  }
  packet.first_q6 = yd_sixty_fourths(angle_deg_);
  packet.last_q6 = yd_sixty_fourths(angle_deg_ + static_cast<double>(count - 1) * step_deg);
  for (const double reading_mm : readings_mm) {
    packet.samples.push_back(
        static_cast<std::uint16_t>(std::lround((settings_.triangulates ? 4.0 : 1.0) * reading_mm)));
  }
  send(devices::yd_bytes(packet));
  angle_deg_ += static_cast<double>(count) * step_deg;
  if (angle_deg_ >= kTurn_deg) {
    angle_deg_ -= kTurn_deg;
    turned_ = true;
    count_turn();
  }
  schedule(next_ns() + std::llround(1e9 * static_cast<double>(count) / settings_.samples_hz));
}

}  // namespace topogeo::simulation
