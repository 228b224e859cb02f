#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/create_protocol.hpp"
#include "topogeo/devices/kobuki_protocol.hpp"
#include "topogeo/devices/pioneer_protocol.hpp"
#include "topogeo/devices/roboteq_protocol.hpp"
#include "topogeo/devices/vesc_protocol.hpp"

#include "base_drive.hpp"
#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kMostBaseOrders = 12;  // per read

/// The reports that a decoder finds if it gets `part` bytes at a time.
template <typename Decoder>
auto found_in_parts(Decoder& decoder, Bytes bytes, std::size_t part) {
  std::vector<typename decltype(decoder.next())::value_type> all;
  for (std::size_t at = 0; at < bytes.size(); at += part) {
    decoder.push(bytes.subspan(at, std::min(part, bytes.size() - at)));
    while (const auto found = decoder.next()) all.push_back(*found);
  }
  return all;
}

template <typename Decoder>
void check_decoder(Bytes bytes) {
  Decoder decoder;
  const auto whole = found_in_parts(decoder, bytes, std::max<std::size_t>(1, bytes.size()));
  for (const std::size_t part : {std::size_t{1}, std::size_t{7}}) {
    Decoder other;
    require(found_in_parts(other, bytes, part) == whole,
            "reports do not depend on how bytes are cut");
    require(other.counters() == decoder.counters(), "nor do the drops");
  }
  for (const auto& report : whole) {
    Decoder again;
    again.push(to_bytes(report));
    require(again.next() == report, "a report that was read can be written and read");
  }
}

std::int16_t big_endian(Bytes data) {
  return static_cast<std::int16_t>(data[0] << 8 | data[1]);
}

/// Orders for a Create: it may get none but these, and no speed beyond its own limit.
void check_create_order(Bytes bytes) {
  namespace order = devices::create_order;
  while (!bytes.empty()) {
    std::size_t size = 1;
    if (bytes[0] == order::kStream) {
      size = devices::create_stream_request().size();
    } else if (bytes[0] == order::kDriveDirect) {
      size = 5;
      require(bytes.size() >= size, "an order is whole");
      for (const std::size_t at : {std::size_t{1}, std::size_t{3}}) {
        require(std::abs(big_endian(bytes.subspan(at))) <= devices::kCreateFastest,
                "wheels turn within the limits");
      }
    } else {
      require(bytes[0] == order::kStart || bytes[0] == order::kSafe, "an order is known");
    }
    require(bytes.size() >= size, "an order is whole");
    bytes = bytes.subspan(size);
  }
}

void check_kobuki_order(Bytes bytes) {
  devices::KobukiReader reader;
  reader.push(bytes);
  while (const auto payload = reader.next()) {
    const auto motion = devices::kobuki_motion(*payload);
    require(motion.has_value(), "an order is known");
    require(std::abs(motion->speed_mmps) <= devices::kKobukiFastest,
            "wheels turn within the limits");
  }
  require(reader.counters() == devices::KobukiCounters(), "an order is whole");
}

void check_pioneer_order(Bytes bytes) {
  namespace command = devices::pioneer_command;
  const devices::BaseLimits limits;
  devices::PioneerReader reader;
  reader.push(bytes);
  while (const auto packet = reader.next()) {
    const auto order = devices::pioneer_order(*packet);
    require(order.has_value(), "an order is known");
    const int size = std::abs(order->value.value_or(0));
    if (order->command == command::kSpeed) {
      require(size <= 1e3 * limits.linear_mps, "the speed is within the limits");
    } else if (order->command == command::kTurn) {
      require(size <= 58 * limits.angular_radps, "the turn is within the limits");
    }
  }
  require(reader.counters() == devices::PioneerCounters(), "an order is whole");
}

/// Packets of the server are checked by the reports in them, too.
void check_pioneer_bytes(Bytes bytes) {
  check_decoder<devices::PioneerReader>(bytes);
  devices::PioneerReader reader;
  reader.push(bytes);
  while (const auto packet = reader.next()) {
    const auto report = devices::pioneer_report(*packet);
    if (!report) continue;
    require(devices::pioneer_report(devices::to_packet(*report)) == report,
            "a report that was read can be written and read");
  }
}

void check_roboteq_order(Bytes bytes) {
  if (bytes.empty()) return;  // settings of the line
  std::string lines(bytes.begin(), bytes.end());
  require(lines.ends_with('\r'), "an order is whole");
  if (lines.starts_with('\r')) lines.erase(0, 1);
  for (std::size_t end = 0; (end = lines.find('\r')) != std::string::npos;
       lines.erase(0, end + 1)) {
    const auto order = devices::roboteq_order(lines.substr(0, end));
    require(order.has_value(), "an order is known");
    if (order->name != "S") continue;
    constexpr double kRpmPerMps = 60.0 * devices::RoboteqSettings().motor_turns_per_m;
    const devices::BaseLimits limits;
    const double most_mps =
        limits.linear_mps + 0.5 * devices::RoboteqSettings().track_m * limits.angular_radps;
    require(std::abs(order->arguments.at(1)) <= 1.0 + kRpmPerMps * most_mps,
            "the speed is within the limits");
  }
}

void check_vesc_order(Bytes bytes) {
  constexpr devices::VescSettings kVesc;
  constexpr double kErpmPerMps = 60.0 * kVesc.pole_pairs * kVesc.motor_turns_per_m;
  const devices::BaseLimits limits;
  const double most_mps = limits.linear_mps + 0.5 * kVesc.track_m * limits.angular_radps;
  devices::VescReader reader;
  reader.push(bytes);
  while (auto packet = reader.next()) {
    if (packet->payload[0] == devices::vesc_command::kForward) {
      packet->payload.erase(packet->payload.begin(), packet->payload.begin() + 2);
    }
    if (*packet == devices::vesc_get_values()) continue;
    const auto erpm = devices::vesc_rpm(*packet);
    require(erpm.has_value(), "an order is known");
    require(std::abs(*erpm) <= 1.0 + kErpmPerMps * most_mps, "the speed is within the limits");
  }
  require(reader.counters() == devices::VescCounters(), "an order is whole");
}

struct FuzzedBase {
  std::string_view model;
  void (*check_bytes)(Bytes bytes);
  void (*check_order)(Bytes order);
};
constexpr std::array<FuzzedBase, 5> kFuzzedBases{
    {{"create2", check_decoder<devices::CreateDecoder>, check_create_order},
     {"kobuki", check_decoder<devices::KobukiDecoder>, check_kobuki_order},
     {"pioneer", check_pioneer_bytes, check_pioneer_order},
     {"roboteq", check_decoder<devices::RoboteqDecoder>, check_roboteq_order},
     {"vesc", check_decoder<devices::VescReader>, check_vesc_order}}};

std::size_t drive(const FuzzedBase& base, Bytes bytes) {
  devices::BaseSettings settings;
  settings.model = &devices::base_model(base.model);
  settings.line.baud = settings.model->baud;
  return drive_base(settings, bytes, [&](const std::vector<devices::LineOrder>& orders) {
    require(orders.size() <= kMostBaseOrders, "a driver does not flood the line");
    for (const devices::LineOrder& order : orders) base.check_order(order.bytes);
  });
}

}  // namespace

std::size_t check_base_driver(std::string_view text) {
  if (text.empty()) return 0;
  const std::vector<std::uint8_t> all(text.begin(), text.end());
  const FuzzedBase& base = kFuzzedBases[all.front() % kFuzzedBases.size()];
  const Bytes bytes = Bytes(all).subspan(1);
  base.check_bytes(bytes);
  return drive(base, bytes);
}

}  // namespace topogeo::fuzz
