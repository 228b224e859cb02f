// Decodes the messages of a base in either dialect.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"

namespace topogeo::devices {

class BaseDecoder {
 public:
  explicit BaseDecoder(const BaseSettings& settings);

  /// The messages that `bytes` complete; `bytes` may be cut anywhere.
  [[nodiscard]] std::vector<McpMessage> decode(std::span<const std::uint8_t> bytes);
  /// Forgets the incomplete message.
  void reset();

  [[nodiscard]] const McpDrops& drops() const;
  /// Lines that repeated a command; 0 in the binary dialect.
  [[nodiscard]] std::uint64_t echoes() const;
  /// Frames accepted with a wrong checksum; 0 in the ASCII dialect.
  [[nodiscard]] std::uint64_t checksum_warnings() const;

 private:
  std::variant<McpAsciiDecoder, McpBinaryDecoder> decoder_;
};

}  // namespace topogeo::devices
