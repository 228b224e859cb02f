#include "topogeo/devices/kobuki_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/devices/little_endian.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kFirstHeader = 0xAA;
constexpr std::uint8_t kSecondHeader = 0x55;
constexpr std::size_t kBeforePayload_bytes = 3;
/// A sub-payload with one byte of data.
constexpr std::size_t kShortest_bytes = 3;
/// All sub-payloads of the protocol in one frame take about 130.
constexpr std::size_t kLongest_bytes = 160;

constexpr std::uint8_t kBasic = 1;
constexpr std::size_t kBasic_bytes = 15;
constexpr std::uint8_t kInertia = 4;
constexpr std::size_t kInertia_bytes = 7;
constexpr std::uint8_t kBaseControl = 1;
constexpr std::size_t kBaseControl_bytes = 4;

std::uint8_t exclusive_or(std::span<const std::uint8_t> bytes) {
  unsigned all = 0;
  for (const std::uint8_t byte : bytes) all ^= byte;
  return static_cast<std::uint8_t>(all);
}

/// Whether `bytes` begin as a frame does, as far as they go.
bool begins_frame(const std::deque<std::uint8_t>& bytes) {
  if (bytes[0] != kFirstHeader) return false;
  if (bytes.size() > 1 && bytes[1] != kSecondHeader) return false;
  return bytes.size() <= 2 || (bytes[2] >= kShortest_bytes && bytes[2] <= kLongest_bytes);
}

void take_basic(std::span<const std::uint8_t> data, KobukiReport& report) {
  report.time_ms = word_at(data, 0);
  report.bumpers = data[2];
  report.drops = data[3];
  report.cliffs = data[4];
  report.ticks = {word_at(data, 5), word_at(data, 7)};
  report.charger = data[12];
  report.battery_dv = data[13];
  report.overcurrent = data[14];
}

/// Whether all sub-payloads fit; `basic`: basic sensor data are among them.
bool take_payload(std::span<const std::uint8_t> payload, KobukiReport& report, bool& basic) {
  while (!payload.empty()) {
    if (payload.size() < 2 || payload.size() < 2U + payload[1]) return false;
    const std::uint8_t id = payload[0];
    const std::span<const std::uint8_t> data = payload.subspan(2, payload[1]);
    if (id == kBasic) {
      if (data.size() != kBasic_bytes) return false;
      take_basic(data, report);
      basic = true;
    } else if (id == kInertia) {
      if (data.size() != kInertia_bytes) return false;
      report.heading_cdeg = static_cast<std::int16_t>(word_at(data, 0));
    }
    payload = payload.subspan(2 + data.size());
  }
  return true;
}

std::int16_t whole(double value) {
  constexpr double kMost = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -kMost, kMost)));
}

}  // namespace

std::vector<std::uint8_t> kobuki_frame(std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> frame;
  frame.reserve(kBeforePayload_bytes + payload.size() + 1);
  frame.push_back(kFirstHeader);
  frame.push_back(kSecondHeader);
  frame.push_back(static_cast<std::uint8_t>(payload.size()));
  for (const std::uint8_t byte : payload) frame.push_back(byte);
  frame.push_back(exclusive_or(std::span(frame).subspan(2)));
  return frame;
}

void KobukiReader::push(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<std::vector<std::uint8_t>> KobukiReader::next() {
  while (!bytes_.empty()) {
    if (!begins_frame(bytes_)) {
      ++counters_.noise_bytes;
      bytes_.pop_front();
      continue;
    }
    if (bytes_.size() < kBeforePayload_bytes) return std::nullopt;
    const std::size_t size = kBeforePayload_bytes + bytes_[2] + 1;
    if (bytes_.size() < size) return std::nullopt;
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(size);
    const std::vector<std::uint8_t> frame(bytes_.begin(), end);
    if (exclusive_or(std::span(frame).subspan(2)) != 0) {
      // A frame that was cut may contain the start of the next one.
      ++counters_.bad_checksum;
      bytes_.pop_front();
      continue;
    }
    bytes_.erase(bytes_.begin(), end);
    return std::vector<std::uint8_t>(frame.begin() + kBeforePayload_bytes, frame.end() - 1);
  }
  return std::nullopt;
}

std::optional<KobukiReport> KobukiDecoder::next() {
  while (const auto payload = reader_.next()) {
    KobukiReport report;
    bool basic = false;
    if (!take_payload(*payload, report, basic)) {
      ++bad_fields_;
    } else if (basic) {
      return report;
    }
  }
  return std::nullopt;
}

KobukiCounters KobukiDecoder::counters() const {
  KobukiCounters counters = reader_.counters();
  counters.bad_fields = bad_fields_;
  return counters;
}

std::vector<std::uint8_t> to_bytes(const KobukiReport& report) {
  std::vector<std::uint8_t> payload{kBasic, kBasic_bytes};
  put_word(payload, report.time_ms);
  payload.insert(payload.end(), {report.bumpers, report.drops, report.cliffs});
  put_word(payload, report.ticks[0]);
  put_word(payload, report.ticks[1]);
  // No power of the motors and no button is read.
  payload.insert(payload.end(), {0, 0, 0, report.charger, report.battery_dv, report.overcurrent});
  if (report.heading_cdeg) {
    payload.insert(payload.end(), {kInertia, kInertia_bytes});
    put_word(payload, static_cast<std::uint16_t>(*report.heading_cdeg));
    payload.insert(payload.end(), {0, 0, 0, 0, 0});
  }
  return kobuki_frame(payload);
}

KobukiMotion kobuki_motion(double linear_mps, double angular_radps, double track_m) {
  constexpr double kLeast = 1e-4;
  constexpr double kLeastRadius_mm = 1.5;  // rounds to more than that of a turn on the spot
  const double half_mm = 500.0 * track_m;
  const double wheel_mmps = 1e3 * std::fabs(linear_mps) + half_mm * std::fabs(angular_radps);
  const double share = std::min(1.0, kKobukiFastest / std::max(wheel_mmps, 1.0));
  const double speed_mmps = share * 1e3 * linear_mps;
  const double turn_radps = share * angular_radps;
  if (std::fabs(turn_radps) < kLeast) return {whole(speed_mmps), 0};
  const double radius_mm = speed_mmps / turn_radps;
  if (std::fabs(radius_mm) < kLeastRadius_mm) return {whole(half_mm * turn_radps), 1};
  // The next curve that the field can hold is nearly straight.
  if (std::fabs(radius_mm) > std::numeric_limits<std::int16_t>::max())
    return {whole(speed_mmps), 0};
  return {whole((radius_mm + std::copysign(half_mm, radius_mm)) * turn_radps), whole(radius_mm)};
}

std::vector<std::uint8_t> to_bytes(const KobukiMotion& motion) {
  std::vector<std::uint8_t> payload{kBaseControl, kBaseControl_bytes};
  put_word(payload, static_cast<std::uint16_t>(motion.speed_mmps));
  put_word(payload, static_cast<std::uint16_t>(motion.radius_mm));
  return kobuki_frame(payload);
}

std::optional<KobukiMotion> kobuki_motion(std::span<const std::uint8_t> payload) {
  if (payload.size() != 2 + kBaseControl_bytes || payload[0] != kBaseControl ||
      payload[1] != kBaseControl_bytes) {
    return std::nullopt;
  }
  return KobukiMotion{static_cast<std::int16_t>(word_at(payload, 2)),
                      static_cast<std::int16_t>(word_at(payload, 4))};
}

}  // namespace topogeo::devices
