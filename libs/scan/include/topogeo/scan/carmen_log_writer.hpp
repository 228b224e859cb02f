// Writes laser scans as FLASER or ROBOTLASER1 lines of a CARMEN text log.
#pragma once

#include <filesystem>
#include <memory>

#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

class CarmenLogWriter {
 public:
  /// Written range of a beam without an echo: the full-scale reading of the laser, which every
  /// CARMEN program interprets as "no return".
  static constexpr float kNoReturnWritten_m = 81.91F;

  /// Creates or replaces the file; gzip if its name ends in .gz. `T_robot_laser`: mounting of the
  /// laser, which the two poses of each line state. Throws std::runtime_error if the file cannot be
  /// written.
  explicit CarmenLogWriter(const std::filesystem::path& path,
                           const geometry::Pose2& T_robot_laser = {});

  /// Closes without reporting errors; call close() to get them.
  ~CarmenLogWriter();
  CarmenLogWriter(CarmenLogWriter&&) noexcept;
  CarmenLogWriter& operator=(CarmenLogWriter&&) noexcept;
  CarmenLogWriter(const CarmenLogWriter&) = delete;
  CarmenLogWriter& operator=(const CarmenLogWriter&) = delete;

  /// Appends one scan: as a FLASER line if its beams are those of such a line (from -90 degrees
  /// over 180, see flaser_angle_step_rad), otherwise as a ROBOTLASER1 line. All numbers are written
  /// with enough digits to read back exactly. Throws std::invalid_argument for a scan that no line
  /// can hold (2 to 2048 ranges, finite and >= 0, within one turn; stamp >= 0), std::runtime_error
  /// if writing fails.
  void write(const Scan& scan);

  /// Flushes and closes. Throws std::runtime_error on failure, for instance on a full disk.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Step between the beams of a FLASER line of `beams` >= 2 readings over 180 degrees: an odd count
/// has a beam at each end, an even count leaves out the last (180 and 181 beams: 1 degree).
double flaser_angle_step_rad(std::size_t beams);

}  // namespace topogeo::scan
