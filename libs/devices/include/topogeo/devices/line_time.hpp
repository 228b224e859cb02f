// Transmission times on a serial line.
#pragma once

#include <cstddef>
#include <cstdint>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

/// A start bit, eight data bits, the parity bit if there is one and a stop bit.
[[nodiscard]] constexpr std::int64_t bits_per_byte(const LineSettings& line) {
  return line.parity == Parity::kNone ? 10 : 11;
}

/// Time between the start of the first of `bytes` and the end of the last, without gaps, rounded
/// up. `line.baud` must not be 0.
[[nodiscard]] constexpr std::int64_t line_time_ns(std::size_t bytes, const LineSettings& line) {
  const std::int64_t bits = static_cast<std::int64_t>(bytes) * bits_per_byte(line);
  return (bits * 1'000'000'000 + line.baud - 1) / line.baud;
}

}  // namespace topogeo::devices
