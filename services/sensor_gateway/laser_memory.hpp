// At which rate the laser sends, in a small file that outlives a gateway that is killed: a laser
// that goes on sending is heard at once there, and is searched for for seconds elsewhere.
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::sensor_gateway {

class LaserMemory {
 public:
  /// An empty path: nothing is kept.
  explicit LaserMemory(std::filesystem::path path) : path_(std::move(path)) {}

  /// What was stored last; empty when that is nothing or damaged. The laser may have another rate
  /// by now.
  [[nodiscard]] std::optional<devices::LineSettings> load() const;
  /// Writes only what has changed. What cannot be written is lost: the laser is searched for.
  void store(const devices::LineSettings& line);

 private:
  std::filesystem::path path_;
  std::optional<devices::LineSettings> stored_;  // by this process
};

}  // namespace topogeo::sensor_gateway
