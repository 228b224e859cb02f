// Faults of a base and its line, injected many times on a simulated clock while the robot drives
// about, and their outcome.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/devices/base_settings.hpp"

namespace topogeo::devices {

struct BaseFaultTest {
  std::string name;
  std::string counted_as;       ///< counters, one of which must grow with every fault
  std::int64_t allowed_ns = 0;  ///< longest recovery
  double right_m = 0.03;        ///< limit of the odometry's error; the same in radians
};

struct BaseFaultResult {
  std::size_t times = 0;
  std::size_t odometries = 0;          ///< published in all
  std::size_t wrong = 0;               ///< with a wrong pose at their stamp, or out of order
  std::size_t uncounted = 0;           ///< faults without growth of any named counter
  std::size_t late = 0;                ///< faults with a recovery that took longer than allowed
  std::size_t unsafe = 0;              ///< times that the robot moved when it must not
  std::int64_t worst_recovery_ns = 0;  ///< from the fault's end to the next odometry
  double worst_m = 0.0;                ///< error of the odometry
  double worst_rad = 0.0;
};

struct BaseFaultLine {
  BaseDialect dialect = BaseDialect::kAscii;
  std::uint32_t baud = 9600;
};

/// All known faults of such a line.
[[nodiscard]] std::vector<BaseFaultTest> base_fault_tests(const BaseFaultLine& line);

/// Injects the fault `times` times. The same seed gives the same result.
[[nodiscard]] BaseFaultResult run_base_fault(const BaseFaultTest& test, const BaseFaultLine& line,
                                             std::size_t times, std::uint64_t seed);

}  // namespace topogeo::devices
