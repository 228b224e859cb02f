// Addresses of devices on a network: "tcp://host:port", "tcp://[::1]:port", and "udp://host:port"
// of a device that takes commands over TCP at that port and sends its data as datagrams.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace topogeo::devices {

struct NetworkAddress {
  std::string host;
  std::optional<std::uint16_t> port{};
  bool datagrams = false;  ///< udp://
  bool operator==(const NetworkAddress&) const = default;
};

/// Whether `path` is the address of a device on a network.
[[nodiscard]] bool is_network_address(std::string_view path);
/// Throws std::invalid_argument for another path, or without a host, or with a wrong port.
[[nodiscard]] NetworkAddress network_address(std::string_view path);
/// `path`, with the port `default_port` if it is an address without one; 0: there is no default.
[[nodiscard]] std::string with_port(const std::string& path, std::uint16_t default_port);

}  // namespace topogeo::devices
