#include "topogeo/devices/body_sensors.hpp"

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::devices {
namespace {

constexpr double kHalfOpening_rad = 7.5 * std::numbers::pi / 180.0;

/// Like b21_sonars: the first one left of ahead.
RangeRing ring_of(std::size_t count, double range_min_m, double range_max_m) {
  RangeRing ring{{}, range_min_m, range_max_m};
  for (std::size_t i = 0; i < count; ++i) {
    const double bearing_rad = geometry::wrap_angle((static_cast<double>(i) + 0.5) * 2.0 *
                                                    std::numbers::pi / static_cast<double>(count));
    const geometry::SinCos direction = geometry::sincos(bearing_rad);
    ring.mounts.push_back(
        {{kB21Radius_m * direction.cos, kB21Radius_m * direction.sin, bearing_rad},
         kHalfOpening_rad});
  }
  return ring;
}

}  // namespace

RangeRing b21_sonar_ring() {
  return ring_of(24, 0.1, 8.0);
}

RangeRing b21_body_infrared() {
  return ring_of(24, 0.04, 0.5);
}

RangeRing b21_base_infrared() {
  return ring_of(32, 0.04, 0.5);
}

std::optional<BodyReadings> MspBodySensors::read(std::int64_t /*now_ns*/) {
  return std::nullopt;
}

std::string MspBodySensors::fault() const {
  return "sonars, infrared and tactile sensors of a B21 are not read: the bus of its sensor "
         "processors is undocumented";
}

}  // namespace topogeo::devices
