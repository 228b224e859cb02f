#include "no_return_search.hpp"

#include <cstdint>
#include <string>

#include "topogeo/scan/carmen_log_reader.hpp"

#include "ros_scans.hpp"

namespace topogeo::recording {
namespace {

void read_carmen(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                 scan::NoReturnSearch& search) {
  scan::CarmenLogReader reader(path, options);
  while (const std::optional<scan::Scan> scan = reader.next()) {
    search.add(scan->ranges_m, scan->T_odom_robot);
    if (search.is_full()) return;
  }
}

/// Uses the readings as they were measured: a correction of motion would change the value.
void read_recording(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                    const std::shared_ptr<const Drive>& drive, scan::NoReturnSearch& search) {
  RosScans scans(path, drive, ros::SweepOrder::kNone, {options.range_max_m},
                 RosScans::Beams::kAsMeasured,
                 [](scan::SkipReason, std::uint64_t, const std::string&) {});
  while (const std::optional<scan::ScanSequence::Candidate> candidate = scans.next()) {
    search.add(candidate->scan.ranges_m, candidate->scan.T_odom_robot);
    if (search.is_full()) return;
  }
}

}  // namespace

std::optional<scan::NoReturn> find_no_return(const std::filesystem::path& path,
                                             const scan::CarmenLogOptions& options,
                                             const std::shared_ptr<const Drive>& drive) {
  if (!options.detect_no_return) return std::nullopt;
  scan::NoReturnSearch search;
  if (drive) {
    read_recording(path, options, drive, search);
  } else {
    read_carmen(path, options, search);
  }
  return search.find();
}

}  // namespace topogeo::recording
