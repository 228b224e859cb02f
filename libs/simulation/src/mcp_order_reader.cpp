#include "topogeo/simulation/mcp_order_reader.hpp"

#include <charconv>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <utility>

#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"

namespace topogeo::simulation {
namespace {

using devices::McpCommand;
using devices::McpOrder;

/// Cuts longer lines: no order is longer, and a line without an end must not fill the memory.
constexpr std::size_t kLongestLine = 80;
/// Packets contain at most four successive zeros: an argument of 0.
constexpr unsigned kSyncZeros = 6;

std::optional<McpOrder> parsed(std::string_view line) {
  const auto command = devices::command_of(line.substr(0, 2));
  if (!command) return std::nullopt;
  std::string_view rest = line.substr(2);
  const std::size_t digit = rest.find_first_not_of(' ');
  rest = digit == std::string_view::npos ? std::string_view{} : rest.substr(digit);
  McpOrder order{*command};
  const auto largest = devices::largest_argument(*command);
  if (rest.empty() != !largest) return std::nullopt;
  if (!largest) return order;
  const char* const end = rest.data() + rest.size();
  const auto [last, error] = std::from_chars(rest.data(), end, order.argument, 16);
  if (error != std::errc() || last != end || order.argument > *largest) return std::nullopt;
  return order;
}

}  // namespace

McpOrderReader::Reading McpOrderReader::read(std::uint8_t byte) {
  return binary_ ? read_binary(byte) : read_ascii(byte);
}

void McpOrderReader::switch_dialect() {
  binary_ = !binary_;
  synchronised_ = false;
  zeros_ = 0;
  packet_.clear();
}

McpOrderReader::Reading McpOrderReader::read_ascii(std::uint8_t byte) {
  if (byte == '\r') return {parsed(std::exchange(line_, {}))};
  if (line_.size() < kLongestLine) line_.push_back(static_cast<char>(byte));
  return {};
}

McpOrderReader::Reading McpOrderReader::read_binary(std::uint8_t byte) {
  zeros_ = byte == 0 ? zeros_ + 1 : 0;
  if (zeros_ >= kSyncZeros) {
    synchronised_ = true;
    packet_.clear();
    return {};
  }
  if (!synchronised_) return {};
  packet_.push_back(byte);
  if (packet_.size() < std::tuple_size_v<devices::McpPacket>) return {};
  std::uint32_t argument = 0;
  for (std::size_t i = 1; i < 5; ++i) argument = argument << 8U | packet_[i];
  const McpOrder order{static_cast<McpCommand>(packet_[0]), argument};
  const bool good = packet_.back() == devices::binary_packet(order).back();
  packet_.clear();
  if (good) return {order};
  synchronised_ = false;
  return {std::nullopt, true};
}

}  // namespace topogeo::simulation
