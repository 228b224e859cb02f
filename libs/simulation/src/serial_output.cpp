#include "topogeo/simulation/serial_output.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::simulation {
namespace {

/// A byte has at most five falling edges, each of which a faster host may read as a start bit.
constexpr std::uint64_t kMostReadPerByte = 5;

std::uint64_t bits_per_second_per_bit(const devices::LineSettings& one,
                                      const devices::LineSettings& other) {
  return static_cast<std::uint64_t>(one.baud) *
         static_cast<std::uint64_t>(devices::bits_per_byte(other));
}

/// Number of bytes that a host reads for the first `sent` bytes of a sender with other settings.
std::uint64_t read_count(std::uint64_t sent, const devices::LineSettings& sender,
                         const devices::LineSettings& host) {
  const std::uint64_t read =
      sent * bits_per_second_per_bit(host, sender) / bits_per_second_per_bit(sender, host);
  return std::min(read, sent * kMostReadPerByte);
}

/// A byte derived from the sent one, its place in the message, and the reading settings (the
/// finisher of splitmix64).
std::uint8_t misread(std::uint8_t sent, std::uint64_t index, const devices::LineSettings& host) {
  std::uint64_t z = (index << 32 ^ host.baud) + sent * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<std::uint8_t>(z ^ (z >> 31));
}

}  // namespace

std::int64_t SerialOutput::send(std::vector<std::uint8_t> bytes, const devices::LineSettings& line,
                                std::int64_t start_ns) {
  Message message{line, std::max(start_ns, free_ns_), std::move(bytes)};
  free_ns_ = message.start_ns + devices::line_time_ns(message.bytes.size(), line);
  messages_.push_back(std::move(message));
  return free_ns_;
}

std::vector<std::uint8_t> SerialOutput::take(const devices::LineSettings& host,
                                             std::int64_t now_ns) {
  std::vector<std::uint8_t> out;
  while (!messages_.empty() && messages_.front().start_ns < now_ns) {
    Message& message = messages_.front();
    std::size_t end = message.bytes.size();
    const std::int64_t since_ns = now_ns - message.start_ns;
    if (since_ns < devices::line_time_ns(end, message.line)) {
      const std::int64_t bits = since_ns * message.line.baud / 1'000'000'000;
      end = static_cast<std::size_t>(bits / devices::bits_per_byte(message.line));
    }
    end = std::max(end, message.taken);
    read_part(message, end, host, out);
    message.taken = end;
    if (end < message.bytes.size()) break;
    messages_.pop_front();
  }
  return out;
}

void SerialOutput::clear() {
  messages_.clear();
  free_ns_ = 0;
}

void SerialOutput::read_part(const Message& message, std::size_t end,
                             const devices::LineSettings& host, std::vector<std::uint8_t>& out) {
  const auto first = message.bytes.begin() + static_cast<std::ptrdiff_t>(message.taken);
  if (host == message.line) {
    out.insert(out.end(), first, message.bytes.begin() + static_cast<std::ptrdiff_t>(end));
    return;
  }
  const std::uint64_t all = read_count(message.bytes.size(), message.line, host);
  const std::uint64_t until = read_count(end, message.line, host);
  for (std::uint64_t i = read_count(message.taken, message.line, host); i < until; ++i) {
    const std::uint64_t source = i * message.bytes.size() / all;
    out.push_back(misread(message.bytes[source], i, host));
  }
}

}  // namespace topogeo::simulation
