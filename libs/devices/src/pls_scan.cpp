#include "topogeo/devices/pls_scan.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;

struct Geometry {
  std::size_t beams;
  double min_deg;
  double step_deg;
};
/// 180 beams are the 181 of 1 deg without the last one.
constexpr std::array<Geometry, 6> kGeometries{{{361, -90.0, 0.5},
                                               {181, -90.0, 1.0},
                                               {180, -90.0, 1.0},
                                               {401, -50.0, 0.25},
                                               {201, -50.0, 0.5},
                                               {101, -50.0, 1.0}}};

/// Fills in the ranges and the flags of the readings; returns the number of returns.
std::size_t read(const PlsMeasuredValues& values, double unit_m, const PlsSettings& settings,
                 LaserScan& scan) {
  std::size_t returns = 0;
  scan.ranges_m.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const PlsReading reading = pls_reading(values.word(i));
    if (reading.dazzled) ++scan.dazzled;
    scan.warning_field = scan.warning_field || reading.warning_field;
    scan.protective_field = scan.protective_field || reading.protective_field;
    const double range_m = reading.distance * unit_m;
    const bool none = reading.distance == 0 || reading.distance >= settings.first_no_return_code ||
                      range_m >= settings.range_max_m ||
                      (reading.dazzled && settings.dazzled_is_no_return);
    scan.ranges_m.push_back(none ? 0.0F : static_cast<float>(range_m));
    if (!none) ++returns;
  }
  return returns;
}

}  // namespace

std::optional<LaserScan> PlsScanMaker::make(const PlsMeasuredValues& values,
                                            const SickTelegram& telegram,
                                            const LineSettings& line) {
  const auto* const geometry = std::ranges::find(kGeometries, values.size(), &Geometry::beams);
  const bool lms = line.parity == Parity::kNone;
  std::uint64_t* reason = nullptr;
  if (geometry == kGeometries.end()) {
    reason = &drops_.beam_count;
  } else if (lms && values.part != 0) {
    reason = &drops_.interlaced;
  } else if (values.health.severity >= PlsSeverity::kError && settings_.drop_at_error) {
    reason = &drops_.sensor_error;
  } else if (values.health.implausible && settings_.drop_implausible) {
    reason = &drops_.implausible;
  }
  if (reason != nullptr) {
    ++*reason;
    return std::nullopt;
  }
  LaserScan scan;
  const std::size_t returns = read(values, lms ? values.unit_m : 0.01, settings_, scan);
  if (is_stuck(values, returns)) {
    ++drops_.stuck;
    return std::nullopt;
  }
  scan.stamp_ns = stamp(telegram, line);
  // Buffered bytes may seem to have arrived at once.
  if (last_stamp_ns_) scan.stamp_ns = std::max(scan.stamp_ns, *last_stamp_ns_ + 1);
  last_stamp_ns_ = scan.stamp_ns;
  scan.angle_min_rad = geometry->min_deg * kDegree_rad;
  scan.angle_step_rad = geometry->step_deg * kDegree_rad;
  scan.contaminated = values.health.polluted;
  return scan;
}

bool PlsScanMaker::is_stuck(const PlsMeasuredValues& values, std::size_t returns) {
  if (std::ranges::equal(values.bytes, last_)) {
    ++identical_;
  } else {
    identical_ = 1;
    last_.assign(values.bytes.begin(), values.bytes.end());
  }
  stuck_ = settings_.stuck_scans > 0 && identical_ >= settings_.stuck_scans &&
           returns >= settings_.stuck_returns;
  return stuck_;
}

std::int64_t PlsScanMaker::stamp(const SickTelegram& telegram, const LineSettings& line) const {
  return telegram.arrived_ns - line_time_ns(telegram.size() + telegram.bytes_since, line) -
         settings_.sweep_to_send_ns;
}

}  // namespace topogeo::devices
