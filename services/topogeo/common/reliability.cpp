#include "common/reliability.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "topogeo/recording/log_reader.hpp"
#include "topogeo/results/map_quality.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

/// Names ranges that are in centimetres or millimetres in a log without units; empty if they look
/// like metres.
std::string unit_hint(const JobOptions& options) {
  constexpr double kNoLimit_m = 1000.0;
  constexpr float kFar_m = 49.9F;  // beyond indoor lasers
  constexpr std::size_t kScans = 200;
  constexpr double kMostFar = 0.3;
  scan::CarmenLogOptions unlimited;
  unlimited.range_max_m = kNoLimit_m;
  unlimited.detect_no_return = false;
  std::size_t readings = 0;
  std::size_t far = 0;
  float largest_m = 0.0F;
  recording::LogReader reader(options.log, unlimited, options.topics);
  for (std::size_t i = 0; i < kScans; ++i) {
    const std::optional<scan::Scan> scan = reader.next();
    if (!scan) break;
    for (const float range_m : scan->ranges_m) {
      if (range_m == scan::Scan::kNoReturn) continue;
      ++readings;
      if (range_m < kFar_m) continue;
      ++far;
      largest_m = std::max(largest_m, range_m);
    }
  }
  if (static_cast<double>(far) <= kMostFar * static_cast<double>(readings)) return {};
  return fmt::format(
      "; {:.0f} % of the readings are beyond {:.1f} m (up to {:.0f}): are they in centimetres or "
      "millimetres? Convert them to metres",
      100.0 * static_cast<double>(far) / static_cast<double>(readings), static_cast<double>(kFar_m),
      static_cast<double>(largest_m));
}

}  // namespace

void check_reliable(const JobOptions& options, const storage::Report& report) {
  if (!results::is_unreliable(report)) return;
  throw service::BadInputError(
      fmt::format("{}: the results are written, but the map is {}: {}{}; try {}",
                  options.log.string(), report.quality.grade, report.quality.reasons.front(),
                  unit_hint(options), report.quality.advice));
}

}  // namespace topogeo::cli
