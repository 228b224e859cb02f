// The ASCII dialect of the MCP: lines of two-letter commands with hexadecimal arguments, reports
// with one line per field. It has no checksum: a value is accepted only if the line's name, place
// and length are right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::devices {

/// Appends the line of a command: `TV afc` and a carriage return. Throws std::invalid_argument for
/// a command without mnemonic and for an argument that is too large.
void append_ascii(const McpOrder& order, std::vector<std::uint8_t>& bytes);

/// A base's line endings and number format, neither of which is known for sure.
struct McpAsciiForm {
  std::string_view line_end = "\r\n";
  bool upper_case = false;
};
/// Appends a report in a base's format, `%PSR` first.
void append_ascii(const McpReport& report, const McpAsciiForm& form,
                  std::vector<std::uint8_t>& bytes);

/// Decodes messages from the bytes of a base, cut anywhere. Skips commands that the base echoes: an
/// answer has the name of a query and a number.
class McpAsciiDecoder {
 public:
  /// `report_mask`: the requested fields (McpField) of the reports.
  explicit McpAsciiDecoder(std::uint32_t report_mask);

  /// Appends the messages that `bytes` complete.
  void decode(std::span<const std::uint8_t> bytes, std::vector<McpMessage>& messages);
  /// Forgets the incomplete line and report.
  void reset();

  [[nodiscard]] const McpDrops& drops() const { return drops_; }
  /// Lines that repeated one of our commands.
  [[nodiscard]] std::uint64_t echoes() const { return echoes_; }

 private:
  void end_line(std::vector<McpMessage>& messages);
  void shorten_line();
  /// A line that starts with %.
  void take_spontaneous(std::string_view line, std::vector<McpMessage>& messages);
  /// A command name with or without a number. False if the line has none.
  bool take_command(std::string_view line, std::vector<McpMessage>& messages);
  void take_field(std::string_view line, std::vector<McpMessage>& messages);
  void start_report();
  void drop_report();

  std::uint32_t mask_;
  std::string line_;
  bool too_long_ = false;
  McpReport report_;
  bool in_report_ = false;
  bool passing_over_ = false;  // skips the rest of a dropped report
  std::size_t next_field_ = 0;
  McpDrops drops_{};
  std::uint64_t echoes_ = 0;
};

}  // namespace topogeo::devices
