// The line protocol for bases of one's own, whatever their microcontroller (docs/base_protocol.md):
// lines of text with a version, fields separated by commas and a CRC-16.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::devices {

inline constexpr int kTextBaseVersion = 1;

/// CRC-16/XMODEM: polynomial 0x1021, from 0.
[[nodiscard]] std::uint16_t text_base_crc(std::string_view body);
/// "$BODY*CRC\n".
[[nodiscard]] std::string text_base_line(std::string_view body);

/// H: what the base is; its answer to "?".
struct TextBaseHello {
  int version = 0;
  std::string name;
};

/// T: the wheels.
struct TextBaseReport {
  std::uint32_t time_ms = 0;                  ///< of the base; wraps
  std::array<std::int32_t, 2> ticks{};        ///< of the left and the right wheel, forward; wrap
  bool emergency_stop = false;                ///< the motors have no power
  bool watchdog = false;                      ///< the base has stopped because no command came
  bool bumper = false;                        ///< one is pressed
  std::optional<std::int32_t> turn_mradps{};  ///< of a gyro, counter-clockwise
};

/// B: the battery.
struct TextBaseBattery {
  std::uint32_t millivolts = 0;
  std::optional<std::uint8_t> percent{};  ///< [0, 100], of a base that measures its charge
};

[[nodiscard]] std::string to_line(const TextBaseHello& hello);
[[nodiscard]] std::string to_line(const TextBaseReport& report);
[[nodiscard]] std::string to_line(const TextBaseBattery& battery);

/// The content of a line. All parts are empty for a message that only the base knows.
struct TextBaseMessage {
  std::optional<TextBaseHello> hello;
  std::optional<TextBaseReport> report;
  std::optional<TextBaseBattery> battery;
};
/// Empty if a field is missing, is no number or out of range. `body` stands between `$` and `*`.
[[nodiscard]] std::optional<TextBaseMessage> text_base_message(std::string_view body);
/// Whole numbers of a body after its letter; empty if one of them is none, or if there are more.
[[nodiscard]] std::optional<std::vector<std::int64_t>> text_base_numbers(std::string_view body);

/// Counts of dropped bytes and lines.
struct TextBaseCounters {
  std::uint64_t noise_bytes = 0;  ///< outside of lines
  std::uint64_t bad_checksum = 0;
  std::uint64_t long_lines = 0;
  bool operator==(const TextBaseCounters&) const = default;
};

/// Finds lines in a stream of bytes that is cut anywhere.
class TextBaseReader {
 public:
  /// The bodies of the complete lines with a right checksum.
  [[nodiscard]] std::vector<std::string> read(std::span<const std::uint8_t> bytes);
  void clear() { line_.clear(); }
  [[nodiscard]] const TextBaseCounters& counters() const { return counters_; }

 private:
  std::string line_;  // from its `$` on
  TextBaseCounters counters_;
};

}  // namespace topogeo::devices
