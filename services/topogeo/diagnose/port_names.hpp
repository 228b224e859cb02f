// The serial ports of this machine and their lasting names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace topogeo::cli {

/// Ports that a laser or a base may be connected to: USB adapters, USB devices and the UART of a
/// single-board computer; sorted.
std::vector<std::filesystem::path> serial_ports(const std::filesystem::path& dev = "/dev");

/// The name of a port in `dev`/serial/by-id, which stays the same when it is plugged in elsewhere
/// or in another order; its absolute path if it has none, and `port` itself if it does not exist.
std::filesystem::path lasting_name(const std::filesystem::path& port,
                                   const std::filesystem::path& dev = "/dev");

}  // namespace topogeo::cli
