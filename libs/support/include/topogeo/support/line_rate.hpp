// Any baud rate of a serial port, also those without a constant in termios.h, such as 256,000.
#pragma once

#include <cstdint>

namespace topogeo::support {

/// Sets both directions of a terminal; false if it is none, or refuses the rate.
[[nodiscard]] bool set_line_rate(int terminal, std::uint32_t baud);

/// The rate of a terminal; 0 if it is none.
[[nodiscard]] std::uint32_t line_rate(int terminal);

}  // namespace topogeo::support
