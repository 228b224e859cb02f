#include "topogeo/devices/mcp_ascii.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <optional>
#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::devices {
namespace {

// A line of a report: the three letters of its field, a blank, the value.
constexpr std::size_t kNameLength = 3;
constexpr std::size_t kValueStart = 4;
/// Longer than any line of the protocol, with room for a prompt.
constexpr std::size_t kMaxLine = 40;

constexpr std::size_t digits_of(std::size_t field) {
  return is_wide(field) ? 8 : 4;
}

/// All of `text` as a hexadecimal number, of either case.
std::optional<std::uint32_t> hexadecimal(std::string_view text) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value, 16);
  if (text.empty() || error != std::errc() || rest != end) return std::nullopt;
  return value;
}

std::string_view without_leading(std::string_view text, std::string_view characters) {
  const std::size_t first = text.find_first_not_of(characters);
  return first == std::string_view::npos ? std::string_view{} : text.substr(first);
}

/// The first field of `mask` at or after `field`; kMcpFields if there is none.
std::size_t field_from(std::uint32_t mask, std::size_t field) {
  if (field >= kMcpFields) return kMcpFields;
  const std::uint32_t rest = mask >> field;
  return rest == 0 ? kMcpFields : field + static_cast<std::size_t>(std::countr_zero(rest));
}

struct EventName {
  std::string_view name;
  bool whole;  // the line is the name only
  McpEventKind kind;
};
// The order matters: TCLR would otherwise match TC.
constexpr std::array kEventNames{
    EventName{"%BHI", true, McpEventKind::kBatteryHigh},
    EventName{"%BLO", true, McpEventKind::kBatteryLow},
    EventName{"%TERR", true, McpEventKind::kTranslateError},
    EventName{"%TCLR", true, McpEventKind::kTranslateCleared},
    EventName{"%TC", false, McpEventKind::kTranslateCurrent},
    EventName{"%RERR", true, McpEventKind::kRotateError},
    EventName{"%RCLR", true, McpEventKind::kRotateCleared},
    EventName{"%RC", false, McpEventKind::kRotateCurrent},
    EventName{"%WDT", false, McpEventKind::kWatchdogExpired},
};

std::optional<McpEvent> event_of_line(std::string_view line) {
  constexpr std::string_view kBump = "%BS ";
  if (line.starts_with(kBump)) {
    const auto value = hexadecimal(without_leading(line.substr(kBump.size()), " "));
    if (!value || *value > 0xFFFFU) return std::nullopt;
    return McpEvent{McpEventKind::kBump, *value};
  }
  for (const EventName& event : kEventNames) {
    if (event.whole ? line == event.name : line.starts_with(event.name)) {
      return McpEvent{event.kind, 0};
    }
  }
  return std::nullopt;
}

void append(std::string_view text, std::vector<std::uint8_t>& bytes) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

}  // namespace

void append_ascii(const McpOrder& order, std::vector<std::uint8_t>& bytes) {
  const std::string_view name = mnemonic(order.command);
  const auto opcode = static_cast<unsigned>(order.command);
  if (name.empty()) {
    throw std::invalid_argument("mcp: command " + std::to_string(opcode) +
                                " has no mnemonic in the ASCII dialect");
  }
  append(name, bytes);
  if (const auto largest = largest_argument(order.command)) {
    if (order.argument > *largest) {
      throw std::invalid_argument("mcp: argument " + std::to_string(order.argument) + " of " +
                                  std::string(name) + " is not in 0.." + std::to_string(*largest));
    }
    append(fmt::format(" {:x}", order.argument), bytes);
  }
  bytes.push_back('\r');
}

void append_ascii(const McpReport& report, const McpAsciiForm& form,
                  std::vector<std::uint8_t>& bytes) {
  append("%PSR", bytes);
  append(form.line_end, bytes);
  for (std::size_t field = field_from(report.mask, 0); field < kMcpFields;
       field = field_from(report.mask, field + 1)) {
    append(field_name(field), bytes);
    append(form.upper_case ? fmt::format(" {:0{}X}", report.fields[field], digits_of(field))
                           : fmt::format(" {:0{}x}", report.fields[field], digits_of(field)),
           bytes);
    append(form.line_end, bytes);
  }
}

McpAsciiDecoder::McpAsciiDecoder(std::uint32_t report_mask) : mask_(report_mask) {
  line_.reserve(kMaxLine + 1);
}

void McpAsciiDecoder::reset() {
  line_.clear();
  too_long_ = false;
  in_report_ = false;
  passing_over_ = false;
}

void McpAsciiDecoder::decode(std::span<const std::uint8_t> bytes,
                             std::vector<McpMessage>& messages) {
  for (const std::uint8_t byte : bytes) {
    if (byte == '\r' || byte == '\n') {
      end_line(messages);
      continue;
    }
    line_.push_back(static_cast<char>(byte));
    if (line_.size() > kMaxLine) shorten_line();
  }
}

/// Garbage may precede a line directly, so a late % may start a line of the base.
void McpAsciiDecoder::shorten_line() {
  if (!too_long_) ++count_of(drops_, McpDrop::kLongLine);
  too_long_ = true;
  const std::size_t last = line_.rfind('%');
  line_.erase(0, last == std::string::npos || last == 0 ? line_.size() : last);
}

void McpAsciiDecoder::end_line(std::vector<McpMessage>& messages) {
  std::string_view line = without_leading(line_, "* ");
  const std::size_t percent = line.rfind('%');
  if (percent != std::string_view::npos) {
    if (percent > 0 && !too_long_) ++count_of(drops_, McpDrop::kUnknownLine);
    take_spontaneous(line.substr(percent), messages);
  } else if (too_long_) {
    if (in_report_) drop_report();
  } else if (!line.empty() && !take_command(line, messages)) {
    take_field(line, messages);
  }
  line_.clear();
  too_long_ = false;
}

void McpAsciiDecoder::take_spontaneous(std::string_view line, std::vector<McpMessage>& messages) {
  if (line == "%PSR") {
    if (in_report_) drop_report();
    start_report();
  } else if (const auto event = event_of_line(line)) {
    messages.emplace_back(*event);
  } else if (in_report_) {
    drop_report();
  } else {
    ++count_of(drops_, McpDrop::kUnknownLine);
  }
}

bool McpAsciiDecoder::take_command(std::string_view line, std::vector<McpMessage>& messages) {
  const auto command = command_of(line.substr(0, 2));
  // Within a report this is a CLK without its last letter.
  if (!command || (in_report_ && *command == McpCommand::kClock)) return false;
  const std::string_view rest = line.substr(2);
  const auto value = hexadecimal(without_leading(rest, " "));
  if (!rest.empty() && !value) return false;
  if (value && is_query(*command)) {
    messages.emplace_back(McpAnswer{*command, *value});
  } else {
    ++echoes_;
  }
  return true;
}

void McpAsciiDecoder::take_field(std::string_view line, std::vector<McpMessage>& messages) {
  if (!in_report_) {
    // Some bases leave out the first line of a report that starts with the clock.
    const bool clock = field_from(mask_, 0) == static_cast<std::size_t>(McpField::kClock) &&
                       line.starts_with(field_name(static_cast<std::size_t>(McpField::kClock)));
    if (!clock) {
      if (!passing_over_) ++count_of(drops_, McpDrop::kUnknownLine);
      return;
    }
    start_report();
  }
  const std::size_t digits = digits_of(next_field_);
  const auto value = line.size() == kValueStart + digits && line[kNameLength] == ' ' &&
                             line.substr(0, kNameLength) == field_name(next_field_)
                         ? hexadecimal(without_leading(line.substr(kValueStart), " "))
                         : std::nullopt;
  if (!value) return drop_report();
  report_.fields[next_field_] = *value;
  next_field_ = field_from(mask_, next_field_ + 1);
  if (next_field_ < kMcpFields) return;
  in_report_ = false;
  messages.emplace_back(report_);
}

void McpAsciiDecoder::start_report() {
  report_ = McpReport{.mask = mask_};
  next_field_ = field_from(mask_, 0);
  in_report_ = next_field_ < kMcpFields;
  passing_over_ = false;
}

void McpAsciiDecoder::drop_report() {
  ++count_of(drops_, McpDrop::kBadReport);
  in_report_ = false;
  passing_over_ = true;
}

}  // namespace topogeo::devices
