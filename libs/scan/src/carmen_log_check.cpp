#include "topogeo/scan/carmen_log_check.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <variant>

#include "topogeo/scan/scan_check.hpp"
#include "topogeo/support/printable.hpp"

#include "carmen_line.hpp"
#include "gz_lines.hpp"

namespace topogeo::scan {
namespace {

constexpr double kNoLimit_m = 1e9;  // every range counts as it is

LogFault fault_of(const LineError& error) {
  return error.ends_early ? LogFault::kTruncated : scan::fault_of(error.reason);
}

class Checker {
 public:
  explicit Checker(const LogCheckOptions& options) : scans_(options), parser_(kNoLimit_m) {}

  void take(const GzLines::Line& line);
  LogCheck finish(const std::string& damage);

 private:
  void take_laser(std::string_view line);
  void found(LogFault fault, const std::string& text) { scans_.found(fault, counts_.lines, text); }

  ScanCheck scans_;
  CarmenLineParser parser_;
  LogCheck counts_;  // of lines
};

void Checker::take(const GzLines::Line& line) {
  ++counts_.lines;
  if (line.too_long) {
    found(LogFault::kText, "more than 1 MiB without a line end");
    return;
  }
  const auto is_binary = [](char c) { return support::is_control(c) && c != '\t'; };
  if (std::any_of(line.text.begin(), line.text.end(), is_binary)) {
    found(LogFault::kText, "binary bytes");
    return;
  }
  switch (line_kind(line.text)) {
    case LineKind::kComment:
      ++counts_.comments;
      break;
    case LineKind::kOdometry:
      ++counts_.odometry_lines;
      break;
    case LineKind::kOther:
      ++counts_.other_lines;
      break;
    case LineKind::kLaser:
      take_laser(line.text);
      break;
  }
}

void Checker::take_laser(std::string_view line) {
  ++counts_.laser_lines;
  std::variant<Scan, LineError> parsed = parser_.parse(line);
  if (const auto* error = std::get_if<LineError>(&parsed)) {
    found(fault_of(*error), error->text);
    return;
  }
  scans_.take(counts_.lines, std::get<Scan>(std::move(parsed)));
}

LogCheck Checker::finish(const std::string& damage) {
  if (!damage.empty()) found(LogFault::kCompression, damage);
  LogCheck check = scans_.finish();
  check.lines = counts_.lines;
  check.laser_lines = counts_.laser_lines;
  check.odometry_lines = counts_.odometry_lines;
  check.comments = counts_.comments;
  check.other_lines = counts_.other_lines;
  return check;
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
    case LogFault::kNoOdometry:
      return "no odometry";
  }
  return "unknown";
}

std::uint64_t LogCheck::faults() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

LogCheck check_carmen_log(const std::filesystem::path& path, const LogCheckOptions& options) {
  Checker checker(options);
  GzLines lines(path);
  GzLines::Line line;
  while (lines.next(line)) checker.take(line);
  LogCheck check = checker.finish(lines.damage());
  if (check.laser_lines == 0) {
    throw std::runtime_error(
        path.string() + ": expected a CARMEN log with FLASER or ROBOTLASER1 lines, got " +
        (check.lines == 0 ? "an empty file" : std::to_string(check.lines) + " lines without one"));
  }
  return check;
}

}  // namespace topogeo::scan
