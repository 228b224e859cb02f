#include "topogeo/devices/text_base_protocol.hpp"

#include <charconv>
#include <limits>

namespace topogeo::devices {
namespace {

constexpr std::size_t kLongestLine = 96;
constexpr std::size_t kLongestName = 40;
constexpr std::uint16_t kPolynomial = 0x1021;
constexpr unsigned kEmergencyStopFlag = 1;
constexpr unsigned kWatchdogFlag = 2;
constexpr unsigned kBumperFlag = 4;
constexpr std::int64_t kMostNumbers = 8;
constexpr std::int64_t kMostPercent = 100;

std::string hexadecimal(std::uint16_t value) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (int shift = 12; shift >= 0; shift -= 4) text += kDigits[value >> shift & 0xF];
  return text;
}

template <typename Number>
bool fits(std::int64_t value) {
  return value >= std::numeric_limits<Number>::min() && value <= std::numeric_limits<Number>::max();
}

std::optional<TextBaseMessage> hello_of(std::string_view body) {
  if (body.size() < 3 || body[1] != ',') return std::nullopt;
  const std::size_t comma = body.find(',', 2);
  const auto version = text_base_numbers(body.substr(0, comma));
  if (!version || version->size() != 1 || comma == std::string_view::npos) return std::nullopt;
  const std::string_view name = body.substr(comma + 1);
  if (name.size() > kLongestName || !fits<int>(version->front())) return std::nullopt;
  return TextBaseMessage{
      TextBaseHello{static_cast<int>(version->front()), std::string(name)}, {}, {}};
}

std::optional<TextBaseMessage> report_of(std::string_view body) {
  const auto numbers = text_base_numbers(body);
  if (!numbers || numbers->size() < 4 || numbers->size() > 5) return std::nullopt;
  const std::vector<std::int64_t>& n = *numbers;
  if (!fits<std::uint32_t>(n[0]) || !fits<std::int32_t>(n[1]) || !fits<std::int32_t>(n[2]) ||
      !fits<std::uint8_t>(n[3]) || !fits<std::int32_t>(n.back())) {
    return std::nullopt;
  }
  TextBaseReport report;
  report.time_ms = static_cast<std::uint32_t>(n[0]);
  report.ticks = {static_cast<std::int32_t>(n[1]), static_cast<std::int32_t>(n[2])};
  const auto flags = static_cast<unsigned>(n[3]);
  report.emergency_stop = (flags & kEmergencyStopFlag) != 0;
  report.watchdog = (flags & kWatchdogFlag) != 0;
  report.bumper = (flags & kBumperFlag) != 0;
  if (n.size() == 5) report.turn_mradps = static_cast<std::int32_t>(n[4]);
  return TextBaseMessage{{}, report, {}};
}

std::optional<TextBaseMessage> battery_of(std::string_view body) {
  const auto numbers = text_base_numbers(body);
  if (!numbers || numbers->empty() || numbers->size() > 2) return std::nullopt;
  const std::vector<std::int64_t>& n = *numbers;
  if (!fits<std::uint32_t>(n[0])) return std::nullopt;
  TextBaseBattery battery{static_cast<std::uint32_t>(n[0])};
  if (n.size() == 2) {
    if (n[1] < 0 || n[1] > kMostPercent) return std::nullopt;
    battery.percent = static_cast<std::uint8_t>(n[1]);
  }
  return TextBaseMessage{{}, {}, battery};
}

}  // namespace

std::uint16_t text_base_crc(std::string_view body) {
  unsigned crc = 0;
  for (const char c : body) {
    crc ^= static_cast<unsigned>(static_cast<unsigned char>(c)) << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? crc << 1 ^ kPolynomial : crc << 1;
    }
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

std::string text_base_line(std::string_view body) {
  return "$" + std::string(body) + "*" + hexadecimal(text_base_crc(body)) + "\n";
}

std::string to_line(const TextBaseHello& hello) {
  return text_base_line("H," + std::to_string(hello.version) + "," + hello.name);
}

std::string to_line(const TextBaseReport& report) {
  const unsigned flags = (report.emergency_stop ? kEmergencyStopFlag : 0U) |
                         (report.watchdog ? kWatchdogFlag : 0U) |
                         (report.bumper ? kBumperFlag : 0U);
  std::string body = "T," + std::to_string(report.time_ms) + "," + std::to_string(report.ticks[0]) +
                     "," + std::to_string(report.ticks[1]) + "," + std::to_string(flags);
  if (report.turn_mradps) body += "," + std::to_string(*report.turn_mradps);
  return text_base_line(body);
}

std::string to_line(const TextBaseBattery& battery) {
  std::string body = "B," + std::to_string(battery.millivolts);
  if (battery.percent) body += "," + std::to_string(*battery.percent);
  return text_base_line(body);
}

std::optional<std::vector<std::int64_t>> text_base_numbers(std::string_view body) {
  std::vector<std::int64_t> numbers;
  std::size_t at = 1;
  while (at < body.size()) {
    if (body[at] != ',' || static_cast<std::int64_t>(numbers.size()) == kMostNumbers) {
      return std::nullopt;
    }
    std::int64_t value = 0;
    const char* const last = body.data() + body.size();
    const auto [end, error] = std::from_chars(body.data() + at + 1, last, value);
    if (error != std::errc()) return std::nullopt;
    at = static_cast<std::size_t>(end - body.data());
    numbers.push_back(value);
  }
  return numbers;
}

std::optional<TextBaseMessage> text_base_message(std::string_view body) {
  if (body.empty()) return std::nullopt;
  switch (body.front()) {
    case 'H':
      return hello_of(body);
    case 'T':
      return report_of(body);
    case 'B':
      return battery_of(body);
    default:
      return TextBaseMessage{};
  }
}

std::vector<std::string> TextBaseReader::read(std::span<const std::uint8_t> bytes) {
  std::vector<std::string> bodies;
  for (const std::uint8_t byte : bytes) {
    const auto c = static_cast<char>(byte);
    if (c == '$') {  // begins a line, wherever it stands
      counters_.noise_bytes += line_.size();
      line_ = "$";
      continue;
    }
    if (line_.empty()) {
      if (c != '\r' && c != '\n') ++counters_.noise_bytes;
      continue;
    }
    if (c == '\r') continue;
    if (c != '\n') {
      line_ += c;
      if (line_.size() > kLongestLine) {
        ++counters_.long_lines;
        line_.clear();
      }
      continue;
    }
    const std::size_t star = line_.rfind('*');
    const bool whole = star != std::string::npos && line_.size() == star + 5;
    std::string body = whole ? line_.substr(1, star - 1) : std::string();
    if (whole && hexadecimal(text_base_crc(body)) == line_.substr(star + 1)) {
      bodies.push_back(std::move(body));
    } else {
      ++counters_.bad_checksum;
    }
    line_.clear();
  }
  return bodies;
}

}  // namespace topogeo::devices
