// Serial protocol of Roboteq motor controllers: lines of text that end with a carriage return,
// without a checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::devices {

/// "C=1200:-7": the answer to a query, or to a request for a setting.
struct RoboteqAnswer {
  std::string name;
  std::vector<std::int32_t> numbers;
  bool operator==(const RoboteqAnswer&) const = default;
};
/// With its carriage return.
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const RoboteqAnswer& answer);

struct RoboteqCounters {
  std::uint64_t bad_lines = 0;  ///< no answer, acknowledgement or echo
  std::uint64_t long_lines = 0;
  bool operator==(const RoboteqCounters&) const = default;
};

/// Finds answers of numbers in a stream of bytes that is cut anywhere. Acknowledgements and the
/// echo of commands are skipped.
class RoboteqDecoder {
 public:
  void push(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<RoboteqAnswer> next();
  void clear();
  [[nodiscard]] const RoboteqCounters& counters() const { return counters_; }

 private:
  void take_line();

  std::string line_;
  bool long_ = false;  // the rest of the line is skipped
  std::deque<RoboteqAnswer> answers_;
  RoboteqCounters counters_;
};

/// A command with its arguments: "!S 1 300" is '!', "S", 1, 300.
struct RoboteqOrder {
  char kind = 0;  ///< ! runtime command, ? query, ^ set, ~ read a setting
  std::string name;
  std::vector<std::int32_t> arguments{};
  bool operator==(const RoboteqOrder&) const = default;
};
/// With its carriage return.
[[nodiscard]] std::string roboteq_line(const RoboteqOrder& order);
/// A line without its end; empty for another one.
[[nodiscard]] std::optional<RoboteqOrder> roboteq_order(std::string_view line);

/// Fault flags (FF) that stop the motors: overheat, overvoltage, undervoltage, short circuit, a
/// failed transistor.
inline constexpr std::int32_t kRoboteqFaults = 0x01 | 0x02 | 0x04 | 0x08 | 0x40;
inline constexpr std::int32_t kRoboteqEmergencyStop = 0x10;

}  // namespace topogeo::devices
