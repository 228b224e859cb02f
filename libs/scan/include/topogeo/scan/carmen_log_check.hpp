// Looks for what is wrong with a CARMEN log, as far as the log itself shows it: for people who
// recorded one, and before hours are spent on mapping it. CarmenLogReader reads on over all of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::scan {

enum class LogFault : std::uint8_t {
  kGap,          ///< no scan for too long
  kReversal,     ///< a time stamp before that of the scan before
  kDuplicate,    ///< the time stamp of the scan before
  kGeometry,     ///< other number or angles of beams than the scan before
  kJump,         ///< odometry faster than any robot of this kind
  kStuck,        ///< the same readings for many scans while there is something to see
  kNumber,       ///< a range or pose that is not finite, negative or absurd
  kStamp,        ///< a time stamp that is no plain decimal number of seconds
  kTruncated,    ///< a line that ends before its last field
  kFields,       ///< surplus or non-numeric fields, angles that no laser has
  kText,         ///< binary bytes, or a line longer than any scan
  kCompression,  ///< the compressed data ends early or is damaged
};
inline constexpr std::size_t kLogFaults = 12;
/// A few words for people: "time reversal".
std::string_view describe(LogFault fault);

struct LogCheckOptions {
  /// Between two scans, >= 0; 0: five times the median, and at least kShortestGap_s, as some logs
  /// have a scan for each metre and others for each turn of the mirror.
  double longest_gap_s = 0.0;
  static constexpr double kShortestGap_s = 2.0;
  double largest_mps = 2.5;        ///< of the odometry between two scans; > 0
  double largest_radps = 6.3;      ///< the same for rotation; > 0
  std::uint32_t stuck_scans = 50;  ///< so many identical scans in a row are a fault; >= 2
  std::size_t findings = 20;       ///< kept of each fault; all are counted
};

struct LogFinding {
  LogFault fault{};
  std::uint64_t line = 0;  ///< counted from 1
  std::string text;        ///< what was found, with numbers
};

struct LogCheck {
  std::uint64_t lines = 0;
  std::uint64_t laser_lines = 0;
  std::uint64_t scans = 0;  ///< laser lines that can be read by themselves
  std::uint64_t odometry_lines = 0;
  std::uint64_t comments = 0;
  std::uint64_t other_lines = 0;
  // Of the readable scans; 0 without one:
  std::size_t beams = 0;         ///< of the first
  double angle_min_rad = 0.0;    ///< the same
  double angle_step_rad = 0.0;   ///< the same
  std::int64_t first_ns = 0;     ///< stamp of the first
  std::int64_t last_ns = 0;      ///< stamp of the last
  double median_period_s = 0.0;  ///< between scans, 0 with less than two
  double longest_period_s = 0.0;
  double path_m = 0.0;  ///< by the odometry, jumps left out
  std::array<std::uint64_t, kLogFaults> counts{};
  std::vector<LogFinding> findings;  ///< in the order of the lines

  [[nodiscard]] std::uint64_t count(LogFault fault) const {
    return counts[static_cast<std::size_t>(fault)];
  }
  [[nodiscard]] std::uint64_t faults() const;
};

/// Throws std::runtime_error when the file cannot be opened, is empty or holds no laser line, and
/// std::invalid_argument when an option is out of range.
LogCheck check_carmen_log(const std::filesystem::path& path, const LogCheckOptions& options = {});

}  // namespace topogeo::scan
