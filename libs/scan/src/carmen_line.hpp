// One line of a CARMEN log: its kind and its scan.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "topogeo/scan/carmen_log_reader.hpp"

namespace topogeo::scan {

enum class LineKind { kComment, kLaser, kOdometry, kOther };

/// Determines the kind by the first field; a blank line is a comment.
LineKind line_kind(std::string_view line);

struct LineError {
  SkipReason reason;
  std::string text;         ///< "expected ..., got ..."
  bool ends_early = false;  ///< the line has fewer fields than it announces
};

/// The two poses of a laser line.
struct LinePoses {
  geometry::Pose2 T_odom_laser;
  geometry::Pose2 T_odom_robot;
};

class CarmenLineParser {
 public:
  explicit CarmenLineParser(double range_max_m) : range_max_m_(range_max_m) {}

  /// The scan of a laser line, its sequence still 0, or the error of the line.
  std::variant<Scan, LineError> parse(std::string_view line);

  /// Only the poses of a laser line; empty if it lacks fields or a pose is invalid.
  std::optional<LinePoses> parse_poses(std::string_view line);

 private:
  /// Field where the pose of the laser begins; that of the robot follows.
  [[nodiscard]] std::size_t find_flaser_poses() const;
  [[nodiscard]] std::size_t find_robotlaser_poses() const;
  void parse_flaser(Scan& scan);
  void parse_robotlaser(Scan& scan);
  std::size_t parse_count(std::size_t field, const char* what) const;
  double parse_number(std::size_t field, SkipReason reason, const char* what) const;
  void parse_ranges(std::size_t first, std::size_t count, double range_max_m, Scan& scan) const;
  geometry::Pose2 parse_pose(std::size_t first) const;

  double range_max_m_;
  std::vector<std::string_view> fields_;  ///< reused to save allocations
};

/// Nanoseconds from a decimal number of seconds such as "1134865040.234209", digit by digit, so
/// that nothing is rounded; digits below a nanosecond are cut off. Empty for anything else: a sign,
/// an exponent, no digit, more than nine billion seconds.
std::optional<std::int64_t> parse_stamp_ns(std::string_view text);

}  // namespace topogeo::scan
