// The ultrasonic, infrared and tactile sensors in the panels of a B21's body and base (Thesis, A.3,
// A.5.3, table A.1), behind one interface.
//
// Counts, places (all around, body or base), ranges and opening angles are documented. Seven sensor
// processors (MSP) read the sensors and share a fast asynchronous bus with the robot's computer. No
// source documents that bus's telegrams or the numbering of the sensors, so MspBodySensors reads
// nothing and reports that; simulation::SimulatedBodySensors measures in a world.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/devices/sonar_ring.hpp"

namespace topogeo::devices {

/// Range sensors of one kind, counter-clockwise.
struct RangeRing {
  std::vector<SonarMount> mounts;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
};

/// 24 in the body: 0.1 to 8 m, 15 degrees from edge to edge (A.5.3.1).
RangeRing b21_sonar_ring();
/// 24 in the body: 0.04 to 0.5 m, 15 degrees (A.5.3.2). The 32 of the base have the same values;
/// they look at the same height and farther down.
RangeRing b21_body_infrared();
RangeRing b21_base_infrared();

inline constexpr std::size_t kB21BodyPanels = 24;
inline constexpr std::size_t kB21BasePanels = 32;

struct BodyReadings {
  std::int64_t stamp_ns = 0;
  std::vector<float> sonar_m;  ///< by mount; scan::Scan::kNoReturn if no echo
  /// Infrared ranges have the order of the mounts, too. Reflections depend on colour and texture,
  /// so a range is rough, and a missing one does not prove free space.
  std::vector<float> body_infrared_m;
  std::vector<float> base_infrared_m;
  std::bitset<kB21BodyPanels> body_pressed;  ///< tactile panels, counter-clockwise, first ahead
  std::bitset<kB21BasePanels> base_pressed;
};

class BodySensors {
 public:
  BodySensors() = default;
  BodySensors(const BodySensors&) = delete;
  BodySensors& operator=(const BodySensors&) = delete;
  virtual ~BodySensors() = default;

  /// The current readings, nanoseconds of any steady clock; nothing if there are none: see fault.
  virtual std::optional<BodyReadings> read(std::int64_t now_ns) = 0;
  /// The reason for missing readings, as readable text; empty if there are readings.
  [[nodiscard]] virtual std::string fault() const = 0;
};

/// Placeholder for the sensors of a real B21. It reads nothing: see above.
class MspBodySensors final : public BodySensors {
 public:
  std::optional<BodyReadings> read(std::int64_t now_ns) override;
  [[nodiscard]] std::string fault() const override;
};

}  // namespace topogeo::devices
