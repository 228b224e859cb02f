// The devices that `topogeo devices` found, for people, for programs, and as a devices file.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/port_recognizer.hpp"

#include "common/text_grid.hpp"

namespace topogeo::cli {

/// The outcome of the search at one port or host.
struct SearchedPort {
  std::string port;   ///< name under which it was searched
  std::string name;   ///< lasting name for the devices file
  std::string error;  ///< reason why it could not be searched; empty if it was
  std::optional<devices::RecognizedDevice> device;
  bool asked = false;    ///< true: the device answered a request; false: it sends by itself
  std::string why_none;  ///< reason why no device was found
};

/// A line for each port, with the lines of the devices file below those with a device.
std::string ports_text(std::span<const SearchedPort> ports, std::size_t columns = kColumns);
/// {"ports": [{"port", "name", "kind", "model", "title", "baud", "device", "asked", "note",
/// "problem"}]}; kind and the following are null without a device.
std::string ports_json(std::span<const SearchedPort> ports);

/// The devices file with the first laser and the first base; further ones are comments. Empty if
/// there is neither.
std::string devices_file(std::span<const SearchedPort> ports);

}  // namespace topogeo::cli
