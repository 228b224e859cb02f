// From the clock of the ports to the one that messages carry.
#pragma once

#include <chrono>
#include <cstdint>

#include "serial_port.hpp"

namespace topogeo::sensor_gateway {

/// Nanoseconds since the epoch that a time of the steady clock stands for. The difference between
/// the clocks is taken once, so that stamps keep their order when the system's clock is set.
class HostTime {
 public:
  HostTime()
      : offset_ns_(std::chrono::duration_cast<std::chrono::nanoseconds>(
                       std::chrono::system_clock::now().time_since_epoch())
                       .count() -
                   steady_now_ns()) {}

  [[nodiscard]] std::int64_t stamp_ns(std::int64_t steady_ns) const {
    return steady_ns + offset_ns_;
  }

 private:
  std::int64_t offset_ns_;
};

}  // namespace topogeo::sensor_gateway
