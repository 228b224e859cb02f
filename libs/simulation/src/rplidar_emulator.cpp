#include "topogeo/simulation/rplidar_emulator.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace topogeo::simulation {
namespace {

using devices::kRpDensePoints;
using devices::kRpExpressPoints;
namespace answer_type = devices::rp_answer;
namespace command_code = devices::rp_command;

constexpr std::uint8_t kRequestStart = 0xA5;
constexpr std::uint8_t kHasPayload = 0x80;
/// Samples of a standard scan that the emulator measures at once.
constexpr std::size_t kStandardPoints = 8;
constexpr std::uint8_t kGoodQuality = 47;

std::uint16_t sixty_fourths(double angle_deg) {
  return static_cast<std::uint16_t>(std::lround(64.0 * angle_deg) % devices::kRpTurnQ6);
}

}  // namespace

RpLidarEmulator::RpLidarEmulator(const RpLidarEmulatorSettings& settings, Ranges ranges,
                                 std::int64_t /*now_ns*/)
    : TurningEmulator(settings.line, {settings.turns_hz, settings.samples_hz}, settings.range_max_m,
                      settings.seed, std::move(ranges)),
      settings_(settings) {}

void RpLidarEmulator::receive(std::span<const std::uint8_t> bytes,
                              const devices::LineSettings& host, std::int64_t now_ns) {
  tick(now_ns);
  if (off_ || is_silent() || host != settings_.line || now_ns < ready_ns_) {
    request_.clear();
    return;
  }
  for (const std::uint8_t byte : bytes) {
    request_.push_back(byte);
    if (request_[0] != kRequestStart) {
      request_.clear();
      continue;
    }
    if (request_.size() < 2) continue;
    const bool payload = (request_[1] & kHasPayload) != 0;
    if (payload && (request_.size() < 3 || request_.size() < 4U + request_[2])) continue;
    const std::vector<std::uint8_t> request = std::exchange(request_, {});
    const std::span<const std::uint8_t> all(request);
    const auto data = payload ? all.subspan(3, request[2]) : std::span<const std::uint8_t>{};
    if (payload && devices::rp_request(request[1], data) != request) continue;  // wrong checksum
    obey(request[1], data, now_ns);
  }
}

void RpLidarEmulator::obey(std::uint8_t command, std::span<const std::uint8_t> payload,
                           std::int64_t now_ns) {
  // Every request ends a scan, except those for the motor.
  const bool motor = command == command_code::kMotorPwm || command == command_code::kMotorSpeed;
  if (motor && payload.size() == 2) {
    motor_command_ = command;
    motor_value_ = static_cast<std::uint16_t>(payload[0] | payload[1] << 8);
    return;
  }
  scan_type_ = 0;
  schedule(kNever_ns);
  switch (command) {
    case command_code::kReset:
      settings_.health = 0;
      return switch_on(now_ns);
    case command_code::kGetInfo: {
      std::array<std::uint8_t, devices::kRpInfo_bytes> info{settings_.model, 29, 1, 7};
      return describe({devices::kRpInfo_bytes, false, answer_type::kInfo}, info, now_ns);
    }
    case command_code::kGetHealth: {
      const std::array<std::uint8_t, 3> health{
          settings_.health, static_cast<std::uint8_t>(settings_.error_code & 0xFFU),
          static_cast<std::uint8_t>(settings_.error_code >> 8)};
      return describe({3, false, answer_type::kHealth}, health, now_ns);
    }
    case command_code::kGetSampleRate: {
      if (!settings_.knows_sample_rate) return;
      const auto express_us = static_cast<unsigned>(std::lround(1e6 / settings_.samples_hz));
      const unsigned standard_us = 2 * express_us;
      const std::array<std::uint8_t, 4> rate{static_cast<std::uint8_t>(standard_us & 0xFFU),
                                             static_cast<std::uint8_t>(standard_us >> 8),
                                             static_cast<std::uint8_t>(express_us & 0xFFU),
                                             static_cast<std::uint8_t>(express_us >> 8)};
      return describe({4, false, answer_type::kSampleRate}, rate, now_ns);
    }
    case command_code::kScan:
      return start_scan(answer_type::kScan, now_ns);
    case command_code::kExpressScan:
      if (payload.empty() || payload[0] > 1) return;
      return start_scan(settings_.mode_type[payload[0]], now_ns);
    default:
      return;
  }
}

void RpLidarEmulator::describe(const devices::RpDescriptor& descriptor,
                               std::span<const std::uint8_t> data, std::int64_t now_ns) {
  std::vector<std::uint8_t> bytes = devices::rp_bytes(descriptor);
  bytes.insert(bytes.end(), data.begin(), data.end());
  answer(std::move(bytes), now_ns + settings_.answer_ns);
}

void RpLidarEmulator::start_scan(std::uint8_t type, std::int64_t now_ns) {
  const auto length = static_cast<std::uint32_t>(
      type == answer_type::kScan ? devices::kRpSample_bytes : devices::kRpPacket_bytes);
  describe({length, true, type}, {}, now_ns);
  scan_type_ = type;
  first_ = true;
  schedule(now_ns + 2 * settings_.answer_ns);
}

void RpLidarEmulator::switch_off() {
  off_ = true;
  scan_type_ = 0;
  request_.clear();
  TurningEmulator::switch_off();
}

void RpLidarEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  off_ = false;
  ready_ns_ = now_ns + settings_.start_up_ns;
}

void RpLidarEmulator::send_packet() {
  const bool standard = scan_type_ == answer_type::kScan;
  const double samples_hz = standard ? 0.5 * settings_.samples_hz : settings_.samples_hz;
  const std::size_t count = standard                            ? kStandardPoints
                            : scan_type_ == answer_type::kDense ? kRpDensePoints
                                                                : kRpExpressPoints;
  const double step_deg = kTurn_deg * settings_.turns_hz / samples_hz;
  const std::vector<double> readings_mm = measure_mm(angle_deg_, step_deg, count);
  std::vector<std::uint8_t> bytes;
  devices::RpPacket packet;
  packet.start_q6 = sixty_fourths(angle_deg_);
  packet.starts = std::exchange(first_, false);
  for (std::size_t i = 0; i < count; ++i) {
    packet.points.push_back({readings_mm[i], 0});
    if (standard) {
      const auto sample = devices::rp_bytes(
          devices::RpSample{std::exchange(turned_, false), kGoodQuality, sixty_fourths(angle_deg_),
                            static_cast<std::uint16_t>(std::lround(4.0 * readings_mm[i]))});
      bytes.insert(bytes.end(), sample.begin(), sample.end());
    }
    angle_deg_ += step_deg;
    if (angle_deg_ < kTurn_deg) continue;
    angle_deg_ -= kTurn_deg;
    turned_ = true;
    count_turn();
  }
  if (!standard) bytes = devices::rp_bytes(packet, scan_type_);
  send(std::move(bytes));
  schedule(next_ns() + std::llround(1e9 * static_cast<double>(count) / samples_hz));
}

}  // namespace topogeo::simulation
