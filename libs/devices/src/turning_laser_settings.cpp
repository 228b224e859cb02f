#include "topogeo/devices/turning_laser_settings.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace topogeo::devices {

double TurningLaserSettings::largest_range_m(double range_max_of_model_m) const {
  return range_max_m > 0.0 ? std::min(range_max_m, range_max_of_model_m) : range_max_of_model_m;
}

void TurningLaserSettings::check() const {
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    if (holds) return;
    throw std::invalid_argument(std::string("laser setting ") + name + " is " +
                                std::to_string(value) + ", expected " + expected);
  };
  require(beams == 0 || (beams >= 90 && beams <= 2048), "beams", static_cast<double>(beams),
          "0 or 90 to 2048");
  require(baud == 0 || (baud >= 9600 && baud <= 3'000'000), "line_baud", baud,
          "0 or 9600 to 3000000");
  require(range_max_m >= 0.0 && range_max_m <= 1000.0, "range_max_m", range_max_m, "0 to 1000");
  require(range_min_m >= 0.0 && range_min_m <= 100.0, "range_min_m", range_min_m, "0 to 100");
  require(packet_delay_ns >= 0 && packet_delay_ns <= 1'000'000'000, "packet_delay_ns",
          static_cast<double>(packet_delay_ns), "0 to 1 s");
  require(silence_ns >= 100'000'000 && silence_ns <= 60'000'000'000, "silence_ns",
          static_cast<double>(silence_ns), "0.1 to 60 s");
}

TurningLaserSettings checked(TurningLaserSettings settings) {
  settings.check();
  return settings;
}

}  // namespace topogeo::devices
