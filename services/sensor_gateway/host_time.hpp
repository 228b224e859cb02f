// Converts the clock of the ports to the clock of the messages.
#pragma once

#include <chrono>
#include <cstdint>

#include "topogeo/support/host.hpp"

#include "serial_port.hpp"

namespace topogeo::sensor_gateway {

/// Converts times of the steady clock to nanoseconds since the epoch. The offset between the clocks
/// is taken once, so that stamps keep their order when the system's clock is set.
class HostTime {
 public:
  HostTime()
      : offset_ns_(std::chrono::duration_cast<std::chrono::nanoseconds>(
                       std::chrono::system_clock::now().time_since_epoch())
                       .count() -
                   support::monotonic_ns()) {}

  [[nodiscard]] std::int64_t stamp_ns(std::int64_t steady_ns) const {
    return steady_ns + offset_ns_;
  }

 private:
  std::int64_t offset_ns_;
};

}  // namespace topogeo::sensor_gateway
