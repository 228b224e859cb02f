#include "topogeo/scan/carmen_log_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <variant>

#include "carmen_line.hpp"
#include "gz_lines.hpp"

namespace topogeo::scan {
namespace {

constexpr double kNoLimit_m = 1e9;  // every range counts as it is
/// Readings in a scan that has something to see.
constexpr std::ptrdiff_t kReturns = 10;
/// Below these, a step is never a jump: stamps and odometry of one instant differ a little.
constexpr double kStepAllowed_m = 0.1;
constexpr double kTurnAllowed_rad = 0.1;

std::string text_of(double value, int digits) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(digits);
  text << value;
  return text.str();
}

LogFault fault_of(const LineError& error) {
  switch (error.reason) {
    case SkipReason::kRange:
    case SkipReason::kPose:
      return LogFault::kNumber;
    case SkipReason::kStamp:
      return LogFault::kStamp;
    default:
      return error.ends_early ? LogFault::kTruncated : LogFault::kFields;
  }
}

class Checker {
 public:
  explicit Checker(const LogCheckOptions& options) : options_(options), parser_(kNoLimit_m) {}

  void take(const GzLines::Line& line);
  void end(const std::string& damage);
  LogCheck& result() { return check_; }

 private:
  void take_laser(std::string_view line);
  void take_scan(Scan scan);
  void compare_time(const Scan& scan);
  void compare_geometry(const Scan& scan);
  void compare_odometry(const Scan& scan);
  void compare_readings(const Scan& scan);
  void find_gaps();
  void found(LogFault fault, const std::string& text) { found(fault, check_.lines, text); }
  void found(LogFault fault, std::uint64_t line, const std::string& text);

  LogCheckOptions options_;
  CarmenLineParser parser_;
  LogCheck check_;
  std::optional<Scan> last_;
  std::uint32_t identical_ = 1;
  std::vector<std::int64_t> periods_ns_;     // between two scans, where time goes on
  std::vector<std::uint64_t> period_lines_;  // of the second of each two
};

void Checker::found(LogFault fault, std::uint64_t line, const std::string& text) {
  if (++check_.counts[static_cast<std::size_t>(fault)] <= options_.findings) {
    check_.findings.push_back({fault, line, text});
  }
}

void Checker::take(const GzLines::Line& line) {
  ++check_.lines;
  if (line.too_long) {
    found(LogFault::kText, "more than 1 MiB without a line end");
    return;
  }
  const auto is_binary = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20U && byte != '\t') || byte == 0x7fU;
  };
  if (std::any_of(line.text.begin(), line.text.end(), is_binary)) {
    found(LogFault::kText, "binary bytes");
    return;
  }
  switch (line_kind(line.text)) {
    case LineKind::kComment:
      ++check_.comments;
      break;
    case LineKind::kOdometry:
      ++check_.odometry_lines;
      break;
    case LineKind::kOther:
      ++check_.other_lines;
      break;
    case LineKind::kLaser:
      take_laser(line.text);
      break;
  }
}

void Checker::take_laser(std::string_view line) {
  ++check_.laser_lines;
  std::variant<Scan, LineError> parsed = parser_.parse(line);
  if (const auto* error = std::get_if<LineError>(&parsed)) {
    found(fault_of(*error), error->text);
    return;
  }
  take_scan(std::get<Scan>(std::move(parsed)));
}

void Checker::take_scan(Scan scan) {
  if (check_.scans++ == 0) {
    check_.beams = scan.ranges_m.size();
    check_.angle_min_rad = scan.angle_min_rad;
    check_.angle_step_rad = scan.angle_step_rad;
    check_.first_ns = scan.stamp_ns;
  }
  check_.last_ns = scan.stamp_ns;
  if (last_) {
    compare_time(scan);
    compare_geometry(scan);
    compare_odometry(scan);
    compare_readings(scan);
  }
  last_ = std::move(scan);
}

void Checker::compare_time(const Scan& scan) {
  const std::int64_t period_ns = scan.stamp_ns - last_->stamp_ns;
  const double period_s = static_cast<double>(period_ns) * 1e-9;
  if (period_ns < 0) {
    found(LogFault::kReversal, text_of(-period_s, 6) + " s before the scan before");
  } else if (period_ns == 0) {
    found(LogFault::kDuplicate, scan.ranges_m == last_->ranges_m
                                    ? "same time and same readings as the scan before"
                                    : "same time as the scan before, other readings");
  } else {
    periods_ns_.push_back(period_ns);
    check_.longest_period_s = std::max(check_.longest_period_s, period_s);
    period_lines_.push_back(check_.lines);
  }
}

void Checker::compare_geometry(const Scan& scan) {
  constexpr double kTolerance_rad = 1e-6;
  if (scan.ranges_m.size() == last_->ranges_m.size() &&
      std::fabs(scan.angle_min_rad - last_->angle_min_rad) <= kTolerance_rad &&
      std::fabs(scan.angle_step_rad - last_->angle_step_rad) <= kTolerance_rad) {
    return;
  }
  const auto beams = [](const Scan& s) {
    return std::to_string(s.ranges_m.size()) + " beams from " + text_of(s.angle_min_rad, 4) +
           " rad by " + text_of(s.angle_step_rad, 5) + " rad";
  };
  found(LogFault::kGeometry, beams(scan) + ", the scan before has " + beams(*last_));
}

void Checker::compare_odometry(const Scan& scan) {
  const double time_s = std::max(0.0, static_cast<double>(scan.stamp_ns - last_->stamp_ns) * 1e-9);
  const geometry::Pose2 step = geometry::between(last_->T_odom_robot, scan.T_odom_robot);
  const double step_m = std::hypot(step.x_m, step.y_m);
  const bool far = step_m > options_.largest_mps * time_s + kStepAllowed_m;
  const bool turned =
      std::fabs(step.theta_rad) > options_.largest_radps * time_s + kTurnAllowed_rad;
  if (far || turned) {
    found(LogFault::kJump, text_of(step_m, 3) + " m and " + text_of(step.theta_rad, 3) +
                               " rad within " + text_of(time_s, 3) + " s");
  } else {
    check_.path_m += step_m;
  }
}

void Checker::compare_readings(const Scan& scan) {
  const bool same = scan.ranges_m == last_->ranges_m;
  identical_ = same ? identical_ + 1 : 1;
  if (identical_ != options_.stuck_scans) return;  // once for each run of them
  const auto returns = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                     [](float range_m) { return range_m != Scan::kNoReturn; });
  if (returns >= kReturns) {
    found(LogFault::kStuck, "the " + std::to_string(identical_) + "th scan with the same readings");
  }
}

void Checker::end(const std::string& damage) {
  if (!damage.empty()) found(LogFault::kCompression, damage);
  if (periods_ns_.empty()) return;
  std::vector<std::int64_t> sorted = periods_ns_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  check_.median_period_s = static_cast<double>(*middle) * 1e-9;
  find_gaps();
}

void Checker::find_gaps() {
  constexpr double kPeriods = 5.0;
  const double longest_s =
      options_.longest_gap_s > 0.0
          ? options_.longest_gap_s
          : std::max(LogCheckOptions::kShortestGap_s, kPeriods * check_.median_period_s);
  for (std::size_t i = 0; i < periods_ns_.size(); ++i) {
    const double period_s = static_cast<double>(periods_ns_[i]) * 1e-9;
    if (period_s > longest_s) {
      found(LogFault::kGap, period_lines_[i], "no scan for " + text_of(period_s, 3) + " s");
    }
  }
  std::stable_sort(check_.findings.begin(), check_.findings.end(),
                   [](const LogFinding& a, const LogFinding& b) { return a.line < b.line; });
}

void check_options(const LogCheckOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(std::isfinite(value) && value > 0.0)) {
      throw std::invalid_argument(std::string(name) + ": expected a finite number > 0, got " +
                                  std::to_string(value));
    }
  };
  if (options.longest_gap_s != 0.0) positive("longest_gap_s", options.longest_gap_s);
  positive("largest_mps", options.largest_mps);
  positive("largest_radps", options.largest_radps);
  if (options.stuck_scans < 2) {
    throw std::invalid_argument("stuck_scans: expected 2 or more, got " +
                                std::to_string(options.stuck_scans));
  }
}

}  // namespace

std::string_view describe(LogFault fault) {
  switch (fault) {
    case LogFault::kGap:
      return "gap";
    case LogFault::kReversal:
      return "time reversal";
    case LogFault::kDuplicate:
      return "duplicate";
    case LogFault::kGeometry:
      return "change of beams";
    case LogFault::kJump:
      return "odometry jump";
    case LogFault::kStuck:
      return "stuck scan";
    case LogFault::kNumber:
      return "impossible number";
    case LogFault::kStamp:
      return "bad time stamp";
    case LogFault::kTruncated:
      return "truncated line";
    case LogFault::kFields:
      return "bad fields";
    case LogFault::kText:
      return "not text";
    case LogFault::kCompression:
      return "damaged compression";
  }
  return "unknown";
}

std::uint64_t LogCheck::faults() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

LogCheck check_carmen_log(const std::filesystem::path& path, const LogCheckOptions& options) {
  check_options(options);
  GzLines lines(path);
  Checker checker(options);
  GzLines::Line line;
  while (lines.next(line)) checker.take(line);
  checker.end(lines.damage());
  LogCheck& check = checker.result();
  if (check.laser_lines == 0) {
    throw std::runtime_error(
        path.string() + ": expected a CARMEN log with FLASER or ROBOTLASER1 lines, got " +
        (check.lines == 0 ? "an empty file" : std::to_string(check.lines) + " lines without one"));
  }
  return std::move(check);
}

}  // namespace topogeo::scan
