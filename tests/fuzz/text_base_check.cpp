#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/text_base_protocol.hpp"

#include "base_drive.hpp"
#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

constexpr std::size_t kMostTextOrders = 5;  // per read

std::vector<std::string> lines_in_parts(devices::TextBaseReader& reader,
                                        std::span<const std::uint8_t> bytes, std::size_t part) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < bytes.size(); at += part) {
    for (std::string& line : reader.read(bytes.subspan(at, std::min(part, bytes.size() - at)))) {
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

/// The body of a written line: between `$` and `*`.
std::string body_of(const std::string& line) {
  return line.substr(1, line.rfind('*') - 1);
}

void check_text_message(const std::string& body) {
  const auto message = devices::text_base_message(body);
  if (!message) return;
  if (message->report) {
    const std::string line = devices::to_line(*message->report);
    const auto again = devices::text_base_message(body_of(line));
    require(again && again->report && devices::to_line(*again->report) == line,
            "a report that was read can be written and read");
  }
  if (message->battery) {
    const auto again = devices::text_base_message(body_of(devices::to_line(*message->battery)));
    require(again && again->battery && again->battery->millivolts == message->battery->millivolts &&
                again->battery->percent == message->battery->percent,
            "a battery that was read can be written and read");
  }
}

/// Pulls the speeds out of the orders for a microcontroller: it may get none beyond its limits.
void check_orders(const std::vector<devices::LineOrder>& orders,
                  const devices::BaseSettings& settings) {
  require(orders.size() <= kMostTextOrders, "a driver does not flood the line");
  devices::TextBaseReader reader;
  for (const devices::LineOrder& order : orders) {
    for (const std::string& body : reader.read(order.bytes)) {
      if (body.empty() || body.front() != 'V') continue;
      const auto numbers = devices::text_base_numbers(body);
      require(numbers && numbers->size() == 3, "an order can be read");
      const double most_mmps = 1000.0 * (settings.limits.linear_mps +
                                         settings.limits.angular_radps * settings.text.track_m) +
                               1.0;
      require(std::fabs(static_cast<double>((*numbers)[0])) <= most_mmps &&
                  std::fabs(static_cast<double>((*numbers)[1])) <= most_mmps,
              "wheels turn within the limits");
    }
  }
}

std::size_t drive(std::span<const std::uint8_t> bytes) {
  devices::BaseSettings settings;
  settings.model = &devices::base_model("microcontroller");
  return drive_base(settings, bytes, [&](const std::vector<devices::LineOrder>& orders) {
    check_orders(orders, settings);
  });
}

}  // namespace

std::size_t check_text_base(std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  devices::TextBaseReader reader;
  const std::vector<std::string> whole =
      lines_in_parts(reader, bytes, std::max<std::size_t>(1, bytes.size()));
  for (const std::size_t part : {std::size_t{1}, std::size_t{7}}) {
    devices::TextBaseReader other;
    require(lines_in_parts(other, bytes, part) == whole,
            "lines do not depend on how bytes are cut");
    require(other.counters() == reader.counters(), "nor do the drops");
  }
  for (const std::string& body : whole) check_text_message(body);
  const std::string next = devices::text_base_line("B,12000");
  const std::vector<std::uint8_t> last(next.begin(), next.end());
  const std::vector<std::string> lines = reader.read(last);
  require(!lines.empty() && lines.back() == "B,12000",
          "whatever came before, the next line is read");
  return drive(bytes);
}

}  // namespace topogeo::fuzz
