// Writes laser scans as FLASER or ROBOTLASER1 lines of a CARMEN text log.
#pragma once

#include <filesystem>
#include <memory>

#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

class CarmenLogWriter {
 public:
  /// What a beam without an echo is written as: the full-scale reading of the laser, which every
  /// CARMEN program takes for "no return".
  static constexpr float kNoReturnWritten_m = 81.91F;

  /// Creates or replaces the file; gzip when its name ends in .gz. `T_robot_laser`: mounting of the
  /// laser, which the two poses of each line state. Throws std::runtime_error when the file cannot
  /// be written.
  explicit CarmenLogWriter(const std::filesystem::path& path,
                           const geometry::Pose2& T_robot_laser = {});

  /// Closes without reporting errors; call close() to hear of them.
  ~CarmenLogWriter();
  CarmenLogWriter(CarmenLogWriter&&) noexcept;
  CarmenLogWriter& operator=(CarmenLogWriter&&) noexcept;
  CarmenLogWriter(const CarmenLogWriter&) = delete;
  CarmenLogWriter& operator=(const CarmenLogWriter&) = delete;

  /// Appends one scan, as a FLASER line when its beams are those of such a line (from -90 degrees
  /// over 180, see flaser_angle_step_rad), else as a ROBOTLASER1 line; all numbers are written with
  /// as many digits as reading back exactly needs. Throws std::invalid_argument for a scan that no
  /// line can hold (2 to 2048 ranges, finite and >= 0, within one turn; stamp >= 0),
  /// std::runtime_error when writing fails.
  void write(const Scan& scan);

  /// Flushes and closes. Throws std::runtime_error when that fails, for instance on a full disk.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Step between the beams of a FLASER line of `beams` >= 2 readings over 180 degrees: an odd count
/// has a beam on each end, an even count leaves out the last (180 and 181 beams: 1 degree).
double flaser_angle_step_rad(std::size_t beams);

}  // namespace topogeo::scan
