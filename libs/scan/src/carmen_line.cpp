#include "carmen_line.hpp"

#include <charconv>
#include <cmath>
#include <numbers>

#include "topogeo/scan/carmen_log_writer.hpp"

namespace topogeo::scan {
namespace {

// Numbers beyond these are damaged: no robot has driven as far or turned as often.
constexpr double kMaxCoordinate_m = 1e6;
constexpr double kMaxHeading_rad = 1e4;

constexpr std::size_t kFlaserCount = 1;      // field with the number of ranges
constexpr std::size_t kRobotlaserCount = 8;  // the same of a ROBOTLASER1 line

// Thrown and caught inside this file only.
struct Bad {
  LineError error;
};

// A field in a form for a one-line message.
std::string quoted(std::string_view field) {
  constexpr std::size_t kLongest = 24;
  std::string text = "'";
  for (const char c : field.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  text += field.size() > kLongest ? "...'" : "'";
  return text;
}

[[noreturn]] void fail(SkipReason reason, const std::string& expected, const std::string& got,
                       bool ends_early = false) {
  throw Bad{{reason, "expected " + expected + ", got " + got, ends_early}};
}

template <typename T>
bool from_text(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  std::size_t i = 0;
  while (i < line.size()) {
    const auto blank = [&] { return line[i] == ' ' || line[i] == '\t'; };
    while (i < line.size() && blank()) ++i;
    const std::size_t begin = i;
    while (i < line.size() && !blank()) ++i;
    if (i > begin) fields.push_back(line.substr(begin, i - begin));
  }
}

std::string_view first_field(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  line.remove_prefix(begin);
  return line.substr(0, line.find_first_of(" \t"));
}

std::int64_t stamp_or_fail(std::string_view text) {
  const auto stamp_ns = parse_stamp_ns(text);
  if (!stamp_ns) fail(SkipReason::kStamp, "a time stamp in seconds", quoted(text));
  return *stamp_ns;
}

}  // namespace

LineKind line_kind(std::string_view line) {
  const std::string_view tag = first_field(line);
  if (tag.empty() || tag.front() == '#') return LineKind::kComment;
  if (tag == "FLASER" || tag == "ROBOTLASER1") return LineKind::kLaser;
  return tag == "ODOM" ? LineKind::kOdometry : LineKind::kOther;
}

std::optional<std::int64_t> parse_stamp_ns(std::string_view text) {
  constexpr std::int64_t kMaxSeconds = 9'000'000'000;
  constexpr int kDigits = 9;
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view part =
      point == std::string_view::npos ? std::string_view() : text.substr(point + 1);
  const auto digits_only = [](std::string_view t) {
    return t.find_first_not_of("0123456789") == std::string_view::npos;
  };
  if (whole.empty() || !digits_only(whole) || !digits_only(part)) return std::nullopt;
  std::int64_t seconds = 0;
  if (!from_text(whole, seconds) || seconds > kMaxSeconds) return std::nullopt;
  std::int64_t nanoseconds = 0;
  for (std::size_t i = 0; i < kDigits; ++i) {
    nanoseconds = 10 * nanoseconds + (i < part.size() ? part[i] - '0' : 0);
  }
  return seconds * 1'000'000'000 + nanoseconds;
}

std::variant<Scan, LineError> CarmenLineParser::parse(std::string_view line) {
  split(line, fields_);
  try {
    Scan scan;
    if (fields_.at(0) == "FLASER") {
      parse_flaser(scan);
    } else {
      parse_robotlaser(scan);
    }
    return scan;
  } catch (Bad& bad) {
    return std::move(bad.error);
  }
}

std::optional<LinePoses> CarmenLineParser::parse_poses(std::string_view line) {
  split(line, fields_);
  try {
    const std::size_t poses =
        fields_.at(0) == "FLASER" ? find_flaser_poses() : find_robotlaser_poses();
    return LinePoses{parse_pose(poses), parse_pose(poses + 3)};
  } catch (const Bad&) {
    return std::nullopt;
  }
}

std::size_t CarmenLineParser::find_flaser_poses() const {
  const std::size_t count = parse_count(kFlaserCount, "number of ranges");
  const std::size_t poses = kFlaserCount + 1 + count;
  const std::size_t expected = poses + 9;
  if (fields_.size() != expected) {
    fail(SkipReason::kFields,
         std::to_string(expected) + " fields (" + std::to_string(count) +
             " ranges, two poses, stamp, host, stamp)",
         std::to_string(fields_.size()), fields_.size() < expected);
  }
  return poses;
}

void CarmenLineParser::parse_flaser(Scan& scan) {
  const std::size_t poses = find_flaser_poses();
  const std::size_t count = poses - kFlaserCount - 1;
  scan.angle_min_rad = -std::numbers::pi / 2.0;
  scan.angle_step_rad = flaser_angle_step_rad(count);
  parse_ranges(kFlaserCount + 1, count, range_max_m_, scan);
  scan.T_odom_robot = parse_pose(poses + 3);
  scan.stamp_ns = stamp_or_fail(fields_[poses + 6]);
}

std::size_t CarmenLineParser::find_robotlaser_poses() const {
  const std::size_t count = parse_count(kRobotlaserCount, "number of ranges");
  const std::size_t remissions_field = kRobotlaserCount + 1 + count;
  std::size_t remissions = 0;
  if (remissions_field >= fields_.size() || !from_text(fields_[remissions_field], remissions) ||
      remissions > CarmenLogReader::kMaxBeams) {
    fail(SkipReason::kFields,
         std::to_string(count) + " ranges followed by the number of remission values",
         remissions_field < fields_.size() ? quoted(fields_[remissions_field])
                                           : std::to_string(fields_.size()) + " fields",
         remissions_field >= fields_.size());
  }
  const std::size_t poses = remissions_field + 1 + remissions;
  const std::size_t expected = poses + 6 + 5 + 3;
  if (fields_.size() != expected) {
    fail(SkipReason::kFields,
         std::to_string(expected) + " fields (" + std::to_string(count) + " ranges, " +
             std::to_string(remissions) + " remission values)",
         std::to_string(fields_.size()), fields_.size() < expected);
  }
  return poses;
}

void CarmenLineParser::parse_robotlaser(Scan& scan) {
  const std::size_t poses = find_robotlaser_poses();
  const std::size_t count = parse_count(kRobotlaserCount, "number of ranges");
  scan.angle_min_rad = parse_number(2, SkipReason::kGeometry, "a start angle");
  scan.angle_step_rad = parse_number(4, SkipReason::kGeometry, "an angular resolution");
  // The tolerance allows a full turn whose step was rounded in the log.
  constexpr double kTurn = 2.0 * std::numbers::pi + 0.01;
  // A hundredth of the finest laser's step; below it, angles divided by the step overflow every
  // integer type.
  constexpr double kFinest_rad = 1e-5;
  if (!(std::fabs(scan.angle_min_rad) <= kTurn) || !(scan.angle_step_rad >= kFinest_rad) ||
      !(scan.angle_step_rad * static_cast<double>(count - 1) <= kTurn)) {
    fail(SkipReason::kGeometry,
         "a start angle and an angular resolution of 0.00001 or more, within one turn",
         quoted(fields_[2]) + " and " + quoted(fields_[4]));
  }
  const double sensor_max_m = parse_number(5, SkipReason::kRange, "a maximum range");
  if (!(sensor_max_m > 0.0)) {
    fail(SkipReason::kRange, "a positive maximum range", quoted(fields_[5]));
  }
  parse_ranges(kRobotlaserCount + 1, count, std::min(range_max_m_, sensor_max_m), scan);
  scan.T_odom_robot = parse_pose(poses + 3);
  scan.stamp_ns = stamp_or_fail(fields_[poses + 11]);
}

std::size_t CarmenLineParser::parse_count(std::size_t field, const char* what) const {
  std::size_t count = 0;
  const std::string expected =
      std::string(what) + " in [2, " + std::to_string(CarmenLogReader::kMaxBeams) + "]";
  if (field >= fields_.size()) fail(SkipReason::kFields, expected, "the end of the line", true);
  if (!from_text(fields_[field], count) || count < 2 || count > CarmenLogReader::kMaxBeams) {
    fail(SkipReason::kFields, expected, quoted(fields_[field]));
  }
  return count;
}

double CarmenLineParser::parse_number(std::size_t field, SkipReason reason,
                                      const char* what) const {
  double value = 0.0;
  if (!from_text(fields_[field], value)) {
    fail(SkipReason::kFields, what, quoted(fields_[field]));
  }
  if (!std::isfinite(value))
    fail(reason, std::string(what) + " that is finite", quoted(fields_[field]));
  return value;
}

void CarmenLineParser::parse_ranges(std::size_t first, std::size_t count, double range_max_m,
                                    Scan& scan) const {
  scan.ranges_m.reserve(count);
  const auto limit_m = static_cast<float>(range_max_m);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view text = fields_[first + i];
    float range_m = 0.0F;
    if (!from_text(text, range_m)) {
      fail(SkipReason::kFields, "range " + std::to_string(i) + " in metres", quoted(text));
    }
    // Logs that were made of ROS scans have nan and inf for no echo.
    if (range_m < 0.0F && std::isfinite(range_m)) {
      fail(SkipReason::kRange, "range " + std::to_string(i) + " not negative", quoted(text));
    }
    scan.ranges_m.push_back(range_m > 0.0F && range_m < limit_m ? range_m : Scan::kNoReturn);
  }
}

geometry::Pose2 CarmenLineParser::parse_pose(std::size_t first) const {
  const double x_m = parse_number(first, SkipReason::kPose, "odometry x");
  const double y_m = parse_number(first + 1, SkipReason::kPose, "odometry y");
  const double theta_rad = parse_number(first + 2, SkipReason::kPose, "odometry theta");
  if (std::fabs(x_m) > kMaxCoordinate_m || std::fabs(y_m) > kMaxCoordinate_m ||
      std::fabs(theta_rad) > kMaxHeading_rad) {
    fail(SkipReason::kPose, "an odometry pose within 1e6 m and 1e4 rad",
         quoted(fields_[first]) + " " + quoted(fields_[first + 1]) + " " +
             quoted(fields_[first + 2]));
  }
  return {x_m, y_m, geometry::wrap_angle(theta_rad)};
}

}  // namespace topogeo::scan
