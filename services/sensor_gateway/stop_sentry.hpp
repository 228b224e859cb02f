// A process of its own that stops a base which obeys its last speeds for ever (a Create 2): it
// writes the order to stop when the gateway was killed, which the kernel tells it at once, and when
// the gateway is frozen and gives no sign of life. It cannot help if the computer freezes or the
// cable comes out.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include <sys/types.h>

namespace topogeo::sensor_gateway {

class StopSentry {
 public:
  /// Starts the process, which writes `stop_bytes` to the open `port` when no sign of life comes
  /// for `after` (> 0), again after each further sign, and when this process ends. Throws
  /// std::system_error if the system has no process for it.
  StopSentry(int port, const std::vector<std::uint8_t>& stop_bytes,
             std::chrono::milliseconds after);
  StopSentry(const StopSentry&) = delete;
  StopSentry& operator=(const StopSentry&) = delete;
  StopSentry(StopSentry&&) = delete;
  StopSentry& operator=(StopSentry&&) = delete;
  /// Ends the process, which stops the base a last time.
  ~StopSentry();

  /// The gateway works: it has orders for the base.
  void alive();

 private:
  int signs_ = -1;
  pid_t process_ = -1;
};

}  // namespace topogeo::sensor_gateway
