// The lasers that have a driver: one row each in laser_models.def.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_settings.hpp"
#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

struct LaserModel {
  std::string_view family;  ///< lasers with the same protocol
  std::string_view name;    ///< value of laser.model
  std::string_view title;   ///< maker and models
  LineSettings line;        ///< of the port while it sends scans, unless the settings change it
  std::size_t beams = 0;    ///< of a scan, unless the settings change it
  double view_deg = 0.0;    ///< angle from the first beam to the last, or 360 for a full turn
  double turns_hz = 0.0;    ///< nominal turns of the mirror a second
  double range_max_m = 0.0;
  std::uint16_t network_port = 0;  ///< TCP; 0: none
  std::unique_ptr<LaserDriver> (*make)(const LaserModel& model,
                                       const LaserSettings& settings) = nullptr;
};

/// All models; the first is the default.
[[nodiscard]] std::span<const LaserModel> laser_models();
/// Throws std::invalid_argument for a name that no model has.
[[nodiscard]] const LaserModel& laser_model(std::string_view name);

/// Whether the model sends its scans as datagrams: its port is udp://HOST.
[[nodiscard]] bool sends_datagrams(const LaserModel& model);

/// The line of a model at the rate of the settings, or at its own.
[[nodiscard]] LineSettings line_of(const LaserModel& model, const TurningLaserSettings& settings);

/// Throws std::invalid_argument naming the first setting that is out of range.
[[nodiscard]] std::unique_ptr<LaserDriver> make_laser_driver(const LaserSettings& settings);

}  // namespace topogeo::devices
