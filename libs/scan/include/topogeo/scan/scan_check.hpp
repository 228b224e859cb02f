// What is wrong with the scans of a log, whatever its format: the part of LogCheck that is about
// the scans themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/scan/carmen_log_check.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

/// The fault that a log has where its reader leaves out a scan for that reason.
LogFault fault_of(SkipReason reason);

class ScanCheck {
 public:
  /// Throws std::invalid_argument when an option is out of range.
  explicit ScanCheck(const LogCheckOptions& options);

  /// A scan that is readable by itself; `line` is where it stands.
  void take(std::uint64_t line, Scan scan);
  void found(LogFault fault, std::uint64_t line, const std::string& text);

  /// All scans have come. Counts of lines are left to the caller.
  LogCheck finish();

 private:
  void compare_time(const Scan& scan);
  void compare_geometry(const Scan& scan);
  void compare_odometry(const Scan& scan);
  void compare_readings(const Scan& scan);
  void find_gaps();
  void found_here(LogFault fault, const std::string& text) { found(fault, line_, text); }

  LogCheckOptions options_;
  LogCheck check_;
  std::uint64_t line_ = 0;
  std::optional<Scan> last_;
  std::uint32_t identical_ = 1;
  std::vector<std::int64_t> periods_ns_;     // between two scans, where time goes on
  std::vector<std::uint64_t> period_lines_;  // of the second of each two
};

}  // namespace topogeo::scan
