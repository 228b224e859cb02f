// Texts of peers and files, fit for a line of a terminal or a log.
#pragma once

#include <string>
#include <string_view>

namespace topogeo::support {

/// Whether a byte moves a cursor, begins an escape sequence or ends a line: 0 to 31 and 127. The
/// control characters beyond ASCII have two bytes in UTF-8 and are not found.
[[nodiscard]] constexpr bool is_control(char byte) {
  return static_cast<unsigned char>(byte) < 0x20 || byte == 0x7f;
}

/// The text with a question mark in place of each control character, those of two bytes in UTF-8
/// (U+0080 to U+009F) included: what a stranger sends neither forges a line nor commands a
/// terminal.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace topogeo::support
