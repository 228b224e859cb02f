// How an emulated RWI base reads its line: orders in the ASCII or in the binary dialect.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::simulation {

class McpOrderReader {
 public:
  /// What a byte completes.
  struct Reading {
    std::optional<devices::McpOrder> order{};
    bool damaged = false;  ///< a binary packet whose checksum is wrong
  };
  /// A line that is no order is passed over. After a damaged packet everything is, up to six zeros;
  /// more of them may follow.
  Reading read(std::uint8_t byte);

  /// From ASCII, with which it starts, to binary or back.
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
