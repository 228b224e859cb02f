// Remembers the laser's baud rate in a small file that survives a killed gateway: a laser that
// keeps sending at that rate is found at once, at any other rate only after a search of seconds.
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::sensor_gateway {

class LaserMemory {
 public:
  /// With an empty path nothing is kept.
  explicit LaserMemory(std::filesystem::path path) : path_(std::move(path)) {}

  /// The rate stored last; empty when there is none or it is damaged. The laser may use another
  /// rate by now.
  [[nodiscard]] std::optional<devices::LineSettings> load() const;
  /// Writes only changes. A failure to write is ignored: the laser is then searched for.
  void store(const devices::LineSettings& line);

 private:
  std::filesystem::path path_;
  std::optional<devices::LineSettings> stored_;  // by this process
};

}  // namespace topogeo::sensor_gateway
