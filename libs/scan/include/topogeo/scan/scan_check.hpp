// Checks the scans of a log of any format: the part of LogCheck about the scans themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/scan/carmen_log_check.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/no_return.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

/// The fault of a log from which a reader skips a scan for this reason.
LogFault fault_of(SkipReason reason);

class ScanCheck {
 public:
  /// Throws std::invalid_argument if an option is out of range.
  explicit ScanCheck(const LogCheckOptions& options);

  /// Takes a scan that is readable by itself; `line` is its place in the log.
  void take(std::uint64_t line, Scan scan);
  void found(LogFault fault, std::uint64_t line, const std::string& text);

  /// Call after the last scan. The caller sets the counts of lines.
  LogCheck finish();

 private:
  void compare_time(const Scan& scan);
  void compare_geometry(const Scan& scan);
  void compare_odometry(const Scan& scan);
  void compare_readings(const Scan& scan);
  void count_readings(const Scan& scan);
  void find_gaps();
  void found_here(LogFault fault, const std::string& text) { found(fault, line_, text); }

  LogCheckOptions options_;
  LogCheck check_;
  std::uint64_t line_ = 0;
  std::optional<Scan> last_;
  std::uint32_t identical_ = 1;
  NoReturnSearch no_return_;
  std::uint64_t readings_ = 0;
  std::uint64_t empty_ = 0;                  // of these
  std::vector<std::int64_t> periods_ns_;     // between two scans, if positive
  std::vector<std::uint64_t> period_lines_;  // line of the second of each two
};

}  // namespace topogeo::scan
