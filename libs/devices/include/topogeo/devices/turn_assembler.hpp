// Collects the beams of a laser that turns all the way round into scans of one grid of angles,
// however many beams a turn has. A turn begins and ends behind the laser, so that the cut lies
// where a robot that drives ahead sees least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

/// One measurement of a laser that turns.
struct TurningBeam {
  double turned_rad = 0.0;   ///< from the laser's own zero, in the sense of its rotation
  double range_m = 0.0;      ///< 0: no return
  std::int64_t time_ns = 0;  ///< of the measurement
  /// The direction of the return differs by this from `turned_rad`, in the same sense: of a laser
  /// whose receiver lies beside the axis. A return that it moves over the cut is left out, because
  /// it has the time of the other end of the turn.
  double aside_rad = 0.0;
};

class TurnAssembler {
 public:
  /// `clockwise`: sense of the laser's rotation, seen from above when it stands upright.
  TurnAssembler(const TurningLaserSettings& settings, std::size_t beams, double range_max_m,
                bool clockwise);

  /// The next beam in order of time. A beam that lies further behind the last one than angles
  /// jitter, or follows after a quarter of a turn, begins a new turn.
  void add(const TurningBeam& beam);
  /// The next beam follows no earlier one.
  void restart();

  /// The scan of the turn that the last beam has completed.
  [[nodiscard]] std::optional<LaserScan> take_scan();

  /// Turns that gave no scan, because more than a tenth of them is missing.
  [[nodiscard]] std::uint64_t incomplete() const { return incomplete_; }

 private:
  void begin_turn(const TurningBeam& beam, double since_cut_rad);
  void finish_turn();
  [[nodiscard]] LaserScan scan_of_turn() const;

  TurningLaserSettings settings_;
  std::size_t beams_;
  double range_max_m_;
  double angle_step_rad_;
  bool mirrored_;  // angles of the laser frame decrease while the laser turns

  std::vector<TurningBeam> turn_;  // turned_rad from the cut, 0 to 2 pi
  double front_rad_ = 0.0;         // largest of these angles
  double covered_rad_ = 0.0;       // of the turn, without gaps
  std::optional<LaserScan> scan_;
  std::int64_t last_stamp_ns_ = 0;
  bool has_stamp_ = false;
  std::uint64_t incomplete_ = 0;
};

}  // namespace topogeo::devices
