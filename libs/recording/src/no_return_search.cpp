#include "no_return_search.hpp"

#include <cstdint>
#include <functional>
#include <string>

#include "topogeo/scan/carmen_log_reader.hpp"

#include "ros_scans.hpp"

namespace topogeo::recording {
namespace {

/// Passes the scans of a log in the order of time to `take`, until that returns false.
using TakeScan = std::function<bool(const scan::Scan&)>;

void read_carmen(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                 const TakeScan& take) {
  scan::CarmenLogReader reader(path, options);
  while (const std::optional<scan::Scan> scan = reader.next()) {
    if (!take(*scan)) return;
  }
}

/// Uses the readings as they were measured: a correction of motion would change the value.
void read_recording(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                    const std::shared_ptr<const Drive>& drive, const TakeScan& take) {
  RosScans scans(path, drive, ros::SweepOrder::kNone, options.range_max_m,
                 RosScans::Beams::kAsMeasured,
                 [](scan::SkipReason, std::uint64_t, const std::string&) {});
  while (const std::optional<scan::ScanSequence::Candidate> candidate = scans.next()) {
    if (!take(candidate->scan)) return;
  }
}

}  // namespace

std::optional<scan::NoReturn> find_no_return(const std::filesystem::path& path,
                                             const scan::CarmenLogOptions& options,
                                             const std::shared_ptr<const Drive>& drive) {
  if (!options.detect_no_return) return std::nullopt;
  const auto read = [&](const TakeScan& take) {
    drive ? read_recording(path, options, drive, take) : read_carmen(path, options, take);
  };
  scan::NoReturnFinder finder;
  read([&](const scan::Scan& scan) {
    finder.add(scan.ranges_m, scan.T_odom_robot);
    return !finder.is_full();
  });
  if (finder.places() > 1) return finder.find();
  // No odometry, or one that stands.
  scan::NoReturnFinder by_views;
  read([&](const scan::Scan& scan) {
    by_views.add_without_odometry(scan.ranges_m);
    return !by_views.is_full();
  });
  return by_views.find();
}

}  // namespace topogeo::recording
