// Checks a CARMEN log for faults that the log itself shows, before hours are spent on mapping it.
// CarmenLogReader skips such faults.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/scan/no_return.hpp"

namespace topogeo::scan {

enum class LogFault : std::uint8_t {
  kGap,          ///< no scan for too long
  kReversal,     ///< a time stamp before that of the previous scan
  kDuplicate,    ///< the time stamp of the previous scan
  kGeometry,     ///< other number or angles of beams than the previous scan
  kJump,         ///< odometry faster than any robot of this kind
  kStuck,        ///< the same readings for many scans with echoes
  kNumber,       ///< a range or pose that is not finite, negative or absurd
  kStamp,        ///< a time stamp that is no plain decimal number of seconds
  kTruncated,    ///< a line that ends before its last field
  kFields,       ///< surplus or non-numeric fields, angles that no laser has
  kText,         ///< binary bytes, or a line longer than any scan
  kCompression,  ///< the compressed data ends early or is damaged
  kNoOdometry,   ///< in a recording: no odometry around the time of the scan
};
inline constexpr std::size_t kLogFaults = 13;
/// Short text for a report: "time reversal".
std::string_view describe(LogFault fault);

struct LogCheckOptions {
  /// Between two scans, >= 0; 0: five times the median and at least kShortestGap_s, because some
  /// logs have a scan per metre and others one per turn of the mirror.
  double longest_gap_s = 0.0;
  static constexpr double kShortestGap_s = 2.0;
  double largest_mps = 2.5;        ///< of the odometry between two scans; > 0
  double largest_radps = 6.3;      ///< the same for rotation; > 0
  std::uint32_t stuck_scans = 50;  ///< this many identical scans in a row are a fault; >= 2
  std::size_t findings = 20;       ///< limit per fault; all are counted
};

struct LogFinding {
  LogFault fault{};
  std::uint64_t line = 0;  ///< counted from 1
  std::string text;        ///< the finding, with numbers
};

struct LogCheck {
  std::uint64_t lines = 0;
  std::uint64_t laser_lines = 0;
  std::uint64_t scans = 0;  ///< laser lines that are readable individually
  std::uint64_t odometry_lines = 0;
  std::uint64_t comments = 0;
  std::uint64_t other_lines = 0;
  // Properties of the readable scans; 0 without any:
  std::size_t beams = 0;         ///< of the first
  double angle_min_rad = 0.0;    ///< the same
  double angle_step_rad = 0.0;   ///< the same
  std::int64_t first_ns = 0;     ///< stamp of the first
  std::int64_t last_ns = 0;      ///< stamp of the last
  double median_period_s = 0.0;  ///< between scans, 0 with fewer than two
  double longest_period_s = 0.0;
  double path_m = 0.0;                ///< by the odometry, without jumps
  std::optional<NoReturn> no_return;  ///< empty if no range means "no echo"
  double empty_share = 0.0;           ///< share of readings of zero, or beyond a stated maximum
  std::array<std::uint64_t, kLogFaults> counts{};
  std::vector<LogFinding> findings;  ///< in the order of the lines

  [[nodiscard]] std::uint64_t count(LogFault fault) const {
    return counts[static_cast<std::size_t>(fault)];
  }
  [[nodiscard]] std::uint64_t faults() const;
};

/// Throws std::runtime_error if the file cannot be opened, is empty or has no laser line, and
/// std::invalid_argument if an option is out of range.
LogCheck check_carmen_log(const std::filesystem::path& path, const LogCheckOptions& options = {});

}  // namespace topogeo::scan
