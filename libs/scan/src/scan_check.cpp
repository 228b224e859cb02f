#include "topogeo/scan/scan_check.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace topogeo::scan {
namespace {

/// Echoes that a scan needs to be checked.
constexpr std::ptrdiff_t kReturns = 10;
/// A smaller step is never a jump: stamps and odometry of one instant differ a little.
constexpr double kStepAllowed_m = 0.1;
constexpr double kTurnAllowed_rad = 0.1;

std::string text_of(double value, int digits) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(digits);
  text << value;
  return text.str();
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

LogFault fault_of(SkipReason reason) {
  switch (reason) {
    case SkipReason::kRange:
    case SkipReason::kPose:
      return LogFault::kNumber;
    case SkipReason::kStamp:
      return LogFault::kStamp;
    case SkipReason::kTime:
      return LogFault::kReversal;
    case SkipReason::kGeometry:
    case SkipReason::kFields:
      return LogFault::kFields;
    case SkipReason::kText:
      return LogFault::kText;
    case SkipReason::kTruncated:
      return LogFault::kCompression;
    case SkipReason::kNoOdometry:
    case SkipReason::kOdometryEnds:
      return LogFault::kNoOdometry;
    case SkipReason::kRepeated:
      return LogFault::kStuck;
  }
  return LogFault::kFields;
}

ScanCheck::ScanCheck(const LogCheckOptions& options) : options_(options) {
  check_options(options);
}

void ScanCheck::found(LogFault fault, std::uint64_t line, const std::string& text) {
  if (++check_.counts[static_cast<std::size_t>(fault)] <= options_.findings) {
    check_.findings.push_back({fault, line, text});
  }
}

void ScanCheck::take(std::uint64_t line, Scan scan) {
  line_ = line;
  if (check_.scans++ == 0) {
    check_.beams = scan.ranges_m.size();
    check_.angle_min_rad = scan.angle_min_rad;
    check_.angle_step_rad = scan.angle_step_rad;
    check_.first_ns = scan.stamp_ns;
  }
  check_.last_ns = scan.stamp_ns;
  count_readings(scan);
  if (last_) {
    compare_time(scan);
    compare_geometry(scan);
    compare_odometry(scan);
    compare_readings(scan);
  }
  last_ = std::move(scan);
}

void ScanCheck::compare_time(const Scan& scan) {
  const std::int64_t period_ns = scan.stamp_ns - last_->stamp_ns;
  const double period_s = static_cast<double>(period_ns) * 1e-9;
  if (period_ns < 0) {
    found_here(LogFault::kReversal, text_of(-period_s, 6) + " s before the previous scan");
  } else if (period_ns == 0) {
    found_here(LogFault::kDuplicate, scan.ranges_m == last_->ranges_m
                                         ? "same time and same readings as the previous scan"
                                         : "same time as the previous scan, other readings");
  } else {
    periods_ns_.push_back(period_ns);
    check_.longest_period_s = std::max(check_.longest_period_s, period_s);
    period_lines_.push_back(line_);
  }
}

void ScanCheck::compare_geometry(const Scan& scan) {
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
  found_here(LogFault::kGeometry, beams(scan) + ", the previous scan has " + beams(*last_));
}

void ScanCheck::compare_odometry(const Scan& scan) {
  const double time_s = std::max(0.0, static_cast<double>(scan.stamp_ns - last_->stamp_ns) * 1e-9);
  const geometry::Pose2 step = geometry::between(last_->T_odom_robot, scan.T_odom_robot);
  const double step_m = std::hypot(step.x_m, step.y_m);
  const bool far = step_m > options_.largest_mps * time_s + kStepAllowed_m;
  const bool turned =
      std::fabs(step.theta_rad) > options_.largest_radps * time_s + kTurnAllowed_rad;
  if (far || turned) {
    found_here(LogFault::kJump, text_of(step_m, 3) + " m and " + text_of(step.theta_rad, 3) +
                                    " rad within " + text_of(time_s, 3) + " s");
  } else {
    check_.path_m += step_m;
  }
}

void ScanCheck::compare_readings(const Scan& scan) {
  const bool same = scan.ranges_m == last_->ranges_m;
  identical_ = same ? identical_ + 1 : 1;
  if (identical_ != options_.stuck_scans) return;  // once per run of identical scans
  const auto returns = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                     [](float range_m) { return range_m != Scan::kNoReturn; });
  if (returns >= kReturns) {
    found_here(LogFault::kStuck,
               "the " + std::to_string(identical_) + "th scan with the same readings");
  }
}

void ScanCheck::count_readings(const Scan& scan) {
  no_return_.add(scan.ranges_m, scan.T_odom_robot);
  readings_ += scan.ranges_m.size();
  empty_ += static_cast<std::uint64_t>(std::ranges::count(scan.ranges_m, Scan::kNoReturn));
}

LogCheck ScanCheck::finish() {
  check_.no_return = no_return_.find();
  if (readings_ > 0) {
    check_.empty_share = static_cast<double>(empty_) / static_cast<double>(readings_);
  }
  if (periods_ns_.empty()) return std::move(check_);
  std::vector<std::int64_t> sorted = periods_ns_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  check_.median_period_s = static_cast<double>(*middle) * 1e-9;
  find_gaps();
  return std::move(check_);
}

void ScanCheck::find_gaps() {
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

}  // namespace topogeo::scan
