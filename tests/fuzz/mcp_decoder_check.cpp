#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/devices/rwi_driver.hpp"

#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Messages = std::vector<devices::McpMessage>;

constexpr std::uint32_t kMask = 0x000A0A7A;
constexpr std::int64_t kPart_ns = 20'000'000;
constexpr std::size_t kPart_bytes = 23;
constexpr std::size_t kMostOrders = 5;  // per part

Bytes written(const devices::McpReport& report, bool ascii) {
  Bytes bytes;
  if (ascii) {
    devices::append_ascii(report, {}, bytes);
  } else {
    devices::append_binary_frame(devices::binary_payload(report, devices::McpCommand::kReportMask),
                                 bytes);
  }
  return bytes;
}

template <typename Decoder>
Messages in_parts(Decoder& decoder, std::span<const std::uint8_t> bytes, std::size_t part) {
  Messages messages;
  for (std::size_t at = 0; at < bytes.size(); at += part) {
    decoder.decode(bytes.subspan(at, std::min(part, bytes.size() - at)), messages);
  }
  return messages;
}

template <typename Decoder>
std::size_t check_decoder(const Decoder& fresh, std::span<const std::uint8_t> bytes, bool ascii) {
  Decoder decoder = fresh;
  const Messages whole = in_parts(decoder, bytes, std::max<std::size_t>(1, bytes.size()));
  for (const std::size_t part : {std::size_t{1}, std::size_t{7}}) {
    Decoder other = fresh;
    require(in_parts(other, bytes, part) == whole, "messages do not depend on how bytes are cut");
    require(other.drops() == decoder.drops(), "nor do the drops");
  }
  for (const devices::McpMessage& message : whole) {
    const auto* const report = std::get_if<devices::McpReport>(&message);
    if (report == nullptr || (!ascii && report->mask > 0xFFFFFFU)) continue;
    Decoder again = fresh;
    require(in_parts(again, written(*report, ascii), 64) == Messages{message},
            "a report that was read can be written and read");
  }
  devices::McpReport next{.mask = kMask};
  next.fields[static_cast<std::size_t>(devices::McpField::kClock)] = 0x02030203;
  const Messages last = in_parts(decoder, written(next, ascii), 64);
  require(!last.empty() && last.back() == devices::McpMessage(next),
          "whatever came before, the next report is read");
  return whole.size();
}

void check_driver(std::span<const std::uint8_t> bytes, devices::BaseDialect dialect) {
  devices::BaseSettings settings;
  settings.dialect = dialect;
  devices::RwiDriver driver(settings);
  std::int64_t now_ns = 0;
  std::int64_t stamp_ns = std::numeric_limits<std::int64_t>::min();
  driver.opened(now_ns);
  for (std::size_t at = 0; at < bytes.size(); at += kPart_bytes) {
    now_ns += kPart_ns;
    driver.receive(bytes.subspan(at, std::min(kPart_bytes, bytes.size() - at)), now_ns);
    driver.tick(now_ns);
    (void)driver.command(0.1, 0.1, now_ns + kPart_ns, now_ns);
    require(driver.due_ns() > now_ns, "a driver does not ask for the time that is");
    require(driver.take_orders().size() <= kMostOrders, "a driver does not flood the line");
    for (const devices::BaseOdometry& odometry : driver.take_odometry()) {
      require(odometry.stamp_ns > stamp_ns, "stamps increase");
      stamp_ns = odometry.stamp_ns;
      const geometry::Pose2& pose = odometry.T_odom_robot;
      require(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.theta_rad),
              "the odometry is finite");
    }
  }
}

}  // namespace

std::size_t check_mcp_decoder(std::string_view text) {
  const Bytes bytes(text.begin(), text.end());
  check_driver(bytes, devices::BaseDialect::kAscii);
  check_driver(bytes, devices::BaseDialect::kBinary);
  return check_decoder(devices::McpAsciiDecoder(kMask), bytes, true) +
         check_decoder(devices::McpBinaryDecoder(), bytes, false);
}

}  // namespace topogeo::fuzz
