// Reads laser scans from a CARMEN text log, plain or gzip.
//
// The format, one message per line, fields separated by blanks, metres, radians, seconds:
//   FLASER n r1..rn x y theta odom_x odom_y odom_theta ipc_stamp host logger_stamp
//   ROBOTLASER1 laser_type start_angle field_of_view angular_resolution maximum_range accuracy
//     remission_mode n r1..rn m i1..im laser_pose(3) robot_pose(3) tv rv forward_safety
//     side_safety turn_axis ipc_stamp host logger_stamp
// ODOM lines, comments (#) and lines of other kinds are counted and skipped. A bad line is skipped
// too, counted by reason and explained with its number; the rest stays usable.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/scan/carmen_log_config.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

/// Reason for skipping a line, or a scan of a recording.
enum class SkipReason : std::uint8_t {
  kFields,        ///< missing, surplus or non-numeric fields
  kRange,         ///< a range that is negative, infinite or not a number
  kPose,          ///< an odometry pose that is not finite or absurdly far away
  kStamp,         ///< a time stamp that is no plain decimal number of seconds
  kTime,          ///< the time does not increase
  kGeometry,      ///< beam angles no laser has, or count or angles differ from the first scan's
  kText,          ///< binary bytes, or a line longer than any scan
  kTruncated,     ///< the compressed data ends early or is damaged; the rest is lost
  kNoOdometry,    ///< in a recording: a gap of odometry around the time of the scan
  kOdometryEnds,  ///< in a recording: before the first odometry or after the last
  kRepeated,      ///< the readings of the scan before, although the robot moves
};
constexpr std::size_t kSkipReasonCount = 11;
/// Text for a scan that is skipped for kRepeated.
inline constexpr std::string_view kRepeatedText =
    "expected new readings, because the robot moves, got those of the scan before";

/// Short text for a report: "bad range".
std::string_view describe(SkipReason reason);

struct CarmenLogStatistics {
  std::uint64_t lines = 0;        ///< all lines read so far
  std::uint64_t laser_lines = 0;  ///< FLASER and ROBOTLASER1, usable or not
  std::uint64_t scans = 0;        ///< scans returned by next()
  std::uint64_t comments = 0;     ///< comments and blank lines
  std::uint64_t odometry_lines = 0;
  std::uint64_t other_lines = 0;                          ///< other kinds of message
  std::array<std::uint64_t, kSkipReasonCount> skipped{};  ///< by SkipReason
  /// "FILE:LINE: expected ..., got ..." of the first skipped line for each reason, in their order.
  std::vector<std::string> messages;
  /// For people, about the odometry that was read so far: poses left out, restarts.
  std::vector<std::string> notes;

  /// Counts a skipped line; keeps the message of the first one for this reason.
  void skip(SkipReason reason, std::string message);
  [[nodiscard]] std::uint64_t skipped_for(SkipReason reason) const {
    return skipped[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] std::uint64_t skipped_total() const;
  /// One line: "1220 scans; skipped 3: 1 bad range, 2 time not increasing".
  [[nodiscard]] std::string summary() const;
};

class CarmenLogReader {
 public:
  static constexpr std::size_t kMaxBeams = 2048;  ///< a line with more is skipped as bad

  /// Opens the log and reads up to its first usable scan. Throws std::runtime_error if the file is
  /// missing, unreadable, empty, binary or has no usable laser line, std::invalid_argument if an
  /// option is out of range.
  explicit CarmenLogReader(const std::filesystem::path& path, const CarmenLogOptions& options = {});
  ~CarmenLogReader();
  CarmenLogReader(CarmenLogReader&&) noexcept;
  CarmenLogReader& operator=(CarmenLogReader&&) noexcept;
  CarmenLogReader(const CarmenLogReader&) = delete;
  CarmenLogReader& operator=(const CarmenLogReader&) = delete;

  /// The next usable scan; empty at the end of the log. Sequence numbers count from 0 without gaps,
  /// stamps increase strictly, and every scan has the geometry of the first.
  std::optional<Scan> next();

  [[nodiscard]] const CarmenLogStatistics& statistics() const;

  /// Share of the file read so far, in [0, 1], by its size on disk.
  [[nodiscard]] double fraction_read() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Number of laser lines in a log: a quick total for a progress bar, never less than the number of
/// usable scans. Throws std::runtime_error if the file cannot be opened.
std::uint64_t count_scans(const std::filesystem::path& path);

}  // namespace topogeo::scan
