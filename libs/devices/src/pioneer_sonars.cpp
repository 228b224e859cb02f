#include "topogeo/devices/pioneer_sonars.hpp"

#include "topogeo/scan/scan.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kOldestRange_ns = 1'000'000'000;
/// The largest range that the servers report stands for no echo.
constexpr double kPioneerNoEcho_m = 5.0;

}  // namespace

void PioneerSonars::take(std::span<const PioneerEcho> echoes, std::int64_t now_ns) {
  static const std::size_t known = pioneer_sonars().size();
  for (const PioneerEcho& echo : echoes) {
    if (echo.number >= known) continue;
    if (echo.number >= ranges_.size()) ranges_.resize(echo.number + std::size_t{1});
    const double range_m = echo.range / units_per_m_;
    ranges_[echo.number] = Range{
        range_m < kPioneerNoEcho_m ? static_cast<float>(range_m) : scan::Scan::kNoReturn, now_ns};
  }
}

std::optional<BodyReadings> PioneerSonars::read(std::int64_t now_ns) {
  BodyReadings readings;
  readings.stamp_ns = now_ns;
  fault_ = ranges_.empty() ? "the base has not reported its sonars yet" : "";
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    if (!ranges_[i] || ranges_[i]->taken_ns < now_ns - kOldestRange_ns) {
      fault_ = "the base does not report its sonar " + std::to_string(i);
      break;
    }
    readings.sonar_m.push_back(ranges_[i]->range_m);
  }
  if (!fault_.empty()) return std::nullopt;
  return readings;
}

}  // namespace topogeo::devices
