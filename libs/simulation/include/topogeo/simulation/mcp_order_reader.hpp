// Reads the line of an emulated RWI base: orders in the ASCII or in the binary dialect.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::simulation {

class McpOrderReader {
 public:
  /// Result of a byte.
  struct Reading {
    std::optional<devices::McpOrder> order{};
    bool damaged = false;  ///< a binary packet with a wrong checksum
  };
  /// Ignores lines that are no order. After a damaged packet ignores everything until six zeros;
  /// more zeros may follow.
  Reading read(std::uint8_t byte);

  /// Switches from ASCII, the initial dialect, to binary or back.
  void switch_dialect();
  [[nodiscard]] bool binary() const { return binary_; }

 private:
  Reading read_ascii(std::uint8_t byte);
  Reading read_binary(std::uint8_t byte);

  bool binary_ = false;
  std::string line_;
  std::vector<std::uint8_t> packet_;
  unsigned zeros_ = 0;
  bool synchronised_ = false;
};

}  // namespace topogeo::simulation
