// Settings of lasers that turn all the way round, of any maker.
#pragma once

#include <cstddef>
#include <cstdint>

namespace topogeo::devices {

struct TurningLaserSettings {
  /// Rate of the line; 0: that of the model.
  std::uint32_t baud = 0;
  /// Beams of a scan; 0: those of the model. All beams of a turn are mapped to this grid.
  std::size_t beams = 0;
  /// Readings from this range on are no return; 0: the largest range of the model.
  double range_max_m = 0.0;
  /// Shorter readings are no return: the robot itself, for example.
  double range_min_m = 0.0;
  /// Readings of less intensity (0 to 255) are no return. No document says which intensity is
  /// noise, hence the default.
  std::uint8_t least_intensity = 0;
  /// The laser hangs upside down: its beams are mirrored.
  bool upside_down = false;
  /// Time between the measurement of the last beam of a packet and the first byte of the packet. No
  /// document states it.
  std::int64_t packet_delay_ns = 0;
  /// Time without a packet after which the laser counts as silent.
  std::int64_t silence_ns = 1'000'000'000;

  /// Readings from here on are no return, for a model with this largest range, m.
  [[nodiscard]] double largest_range_m(double range_max_of_model_m) const;

  /// Throws std::invalid_argument naming the first setting that is out of range.
  void check() const;
};

/// The settings, after check().
[[nodiscard]] TurningLaserSettings checked(TurningLaserSettings settings);

}  // namespace topogeo::devices
