#include "topogeo/devices/create_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

/// A sensor packet: its number and its size.
struct CreatePacket {
  std::uint8_t id;
  std::uint8_t bytes;
};

/// Bumps and wheel drops, cliffs (left, front left, front right, right), charging state, voltage,
/// charge and capacity of the battery, charging sources, mode, encoder counts (left, right).
constexpr std::array<CreatePacket, 13> kCreatePackets{{{7, 1},
                                                       {9, 1},
                                                       {10, 1},
                                                       {11, 1},
                                                       {12, 1},
                                                       {21, 1},
                                                       {22, 2},
                                                       {25, 2},
                                                       {26, 2},
                                                       {34, 1},
                                                       {35, 1},
                                                       {43, 2},
                                                       {44, 2}}};
constexpr std::size_t kHeader_bytes = 2;  // and the length
constexpr std::uint8_t kFrameLength = kCreateFrame_bytes - kHeader_bytes - 1;
constexpr std::int64_t kCreatePeriod_ns = 15'000'000;
constexpr std::uint32_t kCreatePeriodMs = 15;

constexpr unsigned kBumpRight = 1;
constexpr unsigned kBumpLeft = 2;
constexpr unsigned kDropRight = 4;
constexpr unsigned kDropLeft = 8;
constexpr unsigned kAllBumps = 15;
constexpr unsigned kCharger = 1;
constexpr unsigned kDock = 2;
constexpr unsigned kMostCharging = 5;

using Values = std::array<std::uint16_t, kCreatePackets.size()>;

/// Whether `bytes` begin as a frame of these packets does, as far as they go.
bool begins_frame(const std::deque<std::uint8_t>& bytes) {
  const auto is = [&bytes](std::size_t at, std::uint8_t value) {
    return at >= bytes.size() || bytes[at] == value;
  };
  if (!is(0, kCreateStreamHeader) || !is(1, kFrameLength)) return false;
  std::size_t at = kHeader_bytes;
  for (const CreatePacket& packet : kCreatePackets) {
    if (!is(at, packet.id)) return false;
    at += 1U + packet.bytes;
  }
  return true;
}

Values values_of(std::span<const std::uint8_t> frame) {
  Values values{};
  std::size_t at = kHeader_bytes;
  for (std::size_t i = 0; i < values.size(); ++i) {
    ++at;
    values[i] = frame[at++];
    if (kCreatePackets[i].bytes == 2) {
      values[i] = static_cast<std::uint16_t>(values[i] << 8 | frame[at++]);
    }
  }
  return values;
}

/// Empty if a value is none that a device sends.
std::optional<CreateReport> report_of(const Values& values) {
  const auto& [bumps, left, front_left, front_right, right, charging, millivolts, charge_mah,
               capacity_mah, sources, mode, left_ticks, right_ticks] = values;
  if (bumps > kAllBumps || left > 1 || front_left > 1 || front_right > 1 || right > 1 ||
      charging > kMostCharging || sources > (kCharger | kDock) || mode > kMostCreateMode) {
    return std::nullopt;
  }
  CreateReport report;
  report.bump_right = (bumps & kBumpRight) != 0;
  report.bump_left = (bumps & kBumpLeft) != 0;
  report.drop_right = (bumps & kDropRight) != 0;
  report.drop_left = (bumps & kDropLeft) != 0;
  report.cliffs = {left != 0, front_left != 0, front_right != 0, right != 0};
  report.charging = static_cast<std::uint8_t>(charging);
  report.millivolts = millivolts;
  report.charge_mah = charge_mah;
  report.capacity_mah = capacity_mah;
  report.charger = (sources & kCharger) != 0;
  report.dock = (sources & kDock) != 0;
  report.mode = static_cast<std::uint8_t>(mode);
  report.ticks = {left_ticks, right_ticks};
  return report;
}

}  // namespace

std::uint32_t create_period_ms(const LineSettings& line) {
  const std::int64_t periods =
      (line_time_ns(kCreateFrame_bytes, line) + kCreatePeriod_ns - 1) / kCreatePeriod_ns;
  return kCreatePeriodMs * static_cast<std::uint32_t>(periods);
}

std::vector<std::uint8_t> create_stream_request() {
  std::vector<std::uint8_t> order{create_order::kStream, kCreatePackets.size()};
  for (const CreatePacket& packet : kCreatePackets) order.push_back(packet.id);
  return order;
}

std::vector<std::uint8_t> create_drive(double left_mmps, double right_mmps) {
  const double fastest = std::max({std::fabs(left_mmps), std::fabs(right_mmps), 1.0});
  const double share = std::min(1.0, kCreateFastest / fastest);
  std::vector<std::uint8_t> order{create_order::kDriveDirect};
  for (const double speed : {right_mmps, left_mmps}) {
    const auto word = static_cast<std::uint16_t>(std::lround(share * speed));
    order.push_back(static_cast<std::uint8_t>(word >> 8));
    order.push_back(static_cast<std::uint8_t>(word & 0xFFU));
  }
  return order;
}

std::uint8_t create_checksum(std::span<const std::uint8_t> frame) {
  unsigned sum = 0;
  for (const std::uint8_t byte : frame) sum += byte;
  return static_cast<std::uint8_t>(0U - sum);
}

std::vector<std::uint8_t> to_bytes(const CreateReport& report) {
  const unsigned bumps =
      (report.bump_right ? kBumpRight : 0U) | (report.bump_left ? kBumpLeft : 0U) |
      (report.drop_right ? kDropRight : 0U) | (report.drop_left ? kDropLeft : 0U);
  const unsigned sources = (report.charger ? kCharger : 0U) | (report.dock ? kDock : 0U);
  Values values{static_cast<std::uint16_t>(bumps)};
  for (std::size_t i = 0; i < report.cliffs.size(); ++i) values[1 + i] = report.cliffs[i] ? 1 : 0;
  constexpr std::size_t kAfterCliffs = 5;
  const std::array<std::uint16_t, 8> rest{report.charging,
                                          report.millivolts,
                                          report.charge_mah,
                                          report.capacity_mah,
                                          static_cast<std::uint16_t>(sources),
                                          report.mode,
                                          report.ticks[0],
                                          report.ticks[1]};
  std::ranges::copy(rest, values.begin() + kAfterCliffs);
  std::vector<std::uint8_t> frame{kCreateStreamHeader, kFrameLength};
  for (std::size_t i = 0; i < values.size(); ++i) {
    frame.push_back(kCreatePackets[i].id);
    if (kCreatePackets[i].bytes == 2) frame.push_back(static_cast<std::uint8_t>(values[i] >> 8));
    frame.push_back(static_cast<std::uint8_t>(values[i] & 0xFFU));
  }
  frame.push_back(create_checksum(frame));
  return frame;
}

void CreateDecoder::push(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<CreateReport> CreateDecoder::next() {
  while (!bytes_.empty()) {
    if (!begins_frame(bytes_)) {
      ++counters_.noise_bytes;
      bytes_.pop_front();
      continue;
    }
    if (bytes_.size() < kCreateFrame_bytes) return std::nullopt;
    const std::vector<std::uint8_t> frame(bytes_.begin(), bytes_.begin() + kCreateFrame_bytes);
    if (create_checksum(frame) != 0) {
      // A frame that was cut may contain the start of the next one.
      ++counters_.bad_checksum;
      bytes_.pop_front();
      continue;
    }
    bytes_.erase(bytes_.begin(), bytes_.begin() + kCreateFrame_bytes);
    if (auto report = report_of(values_of(frame))) return report;
    ++counters_.bad_fields;
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
