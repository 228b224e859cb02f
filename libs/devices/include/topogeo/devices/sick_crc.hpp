// The check word at the end of every telegram of SICK PLS and LMS lasers. It steps once per byte,
// not once per bit, so it is none of the usual CRC-16 functions.
#pragma once

#include <cstdint>
#include <span>

namespace topogeo::devices {

/// The check word of `bytes`, a telegram without its check word, starting with the STX. It is sent
/// low byte first.
[[nodiscard]] std::uint16_t sick_crc(std::span<const std::uint8_t> bytes);

}  // namespace topogeo::devices
