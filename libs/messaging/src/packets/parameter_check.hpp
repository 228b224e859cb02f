// Whether what peers say of themselves can be read: the payloads of discovery and of the handshake
// of security (Object Management Group, DDSI-RTPS 2.3, chapter 9.6.3; DDS Security 1.1,
// chapters 7.2 and 9.3). Fast DDS 2.9.1 makes as many entries as such a payload states, jumps as
// far in it as it asks for, and reads texts to their zero wherever that is.
#pragma once

#include <cstdint>
#include <span>

namespace topogeo::messaging {

/// `payload` with its encapsulation. Takes out descriptions of types: types are matched by their
/// names here, and the middleware would read a description with memory for any count in it.
[[nodiscard]] bool check_parameters(std::span<std::uint8_t> payload);

/// A message by which participants authenticate each other before anything is encrypted.
[[nodiscard]] bool check_handshake(std::span<const std::uint8_t> payload);

}  // namespace topogeo::messaging
