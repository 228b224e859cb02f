#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/line_time.hpp"

#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

/// The bytes of one read.
constexpr std::size_t kLaserRead_bytes = 61;

void check_turn(const devices::LaserScan& scan, const devices::LaserModel& model,
                std::int64_t last_ns) {
  require(scan.stamp_ns > last_ns, "stamps increase strictly");
  require(scan.ranges_m.size() == model.beams, "all scans have the beams of the model");
  require(std::isfinite(scan.angle_min_rad) && scan.angle_step_rad > 0.0, "angles are usable");
  require(std::isfinite(scan.first_beam_s) && std::isfinite(scan.time_step_s),
          "times of beams are numbers");
  require(std::ranges::all_of(scan.ranges_m,
                              [&model](float range_m) {
                                return std::isfinite(range_m) && range_m >= 0.0F &&
                                       range_m <= static_cast<float>(model.range_max_m);
                              }),
          "ranges are below the largest");
}

}  // namespace

std::size_t check_laser_driver(std::string_view text) {
  if (text.empty()) return 0;
  const auto models = devices::laser_models();
  const devices::LaserModel& model =
      models[static_cast<std::uint8_t>(text.front()) % models.size()];
  if (model.family == "pls") return 0;  // check_sick_decoder() has it
  const std::vector<std::uint8_t> bytes(text.begin() + 1, text.end());
  devices::LaserSettings settings;
  settings.model = &model;
  const auto driver = devices::make_laser_driver(settings);
  std::int64_t now_ns = 0;
  std::int64_t last_ns = -10'000'000'000;
  std::size_t scans = 0;
  driver->opened(now_ns);
  const std::span<const std::uint8_t> all(bytes);
  for (std::size_t at = 0; at < all.size(); at += kLaserRead_bytes) {
    const auto read = all.subspan(at, std::min(kLaserRead_bytes, all.size() - at));
    now_ns += devices::line_time_ns(read.size(), model.line);
    driver->receive(read, now_ns);
    (void)driver->take_orders();
    for (const devices::LaserScan& scan : driver->take_scans()) {
      check_turn(scan, model, last_ns);
      last_ns = scan.stamp_ns;
      ++scans;
    }
    driver->tick(now_ns);
    require(driver->due_ns() > now_ns, "nothing is due any more after a tick");
  }
  driver->end(now_ns);
  (void)driver->health();
  return scans;
}

}  // namespace topogeo::fuzz
