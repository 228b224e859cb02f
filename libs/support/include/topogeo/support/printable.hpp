// Texts from peers and files, made safe for a line of a terminal or a log.
#pragma once

#include <string>
#include <string_view>

namespace topogeo::support {

/// Whether a byte moves a cursor, begins an escape sequence or ends a line: 0 to 31 and 127. Does
/// not detect the control characters beyond ASCII, which have two bytes in UTF-8.
[[nodiscard]] constexpr bool is_control(char byte) {
  return static_cast<unsigned char>(byte) < 0x20 || byte == 0x7f;
}

/// The text with a question mark in place of each control character, including those of two bytes
/// in UTF-8 (U+0080 to U+009F), so that foreign text can neither forge a line nor control a
/// terminal.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace topogeo::support
