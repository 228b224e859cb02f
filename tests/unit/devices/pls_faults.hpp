// Faults of a laser and its line, injected many times on a simulated clock, and their outcome.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace topogeo::devices {

struct PlsFaultTest {
  std::string name;
  std::string counted_as;       ///< counters, one of which must grow with every fault
  std::int64_t allowed_ns = 0;  ///< longest recovery
};

struct PlsFaultResult {
  std::size_t times = 0;
  std::size_t scans = 0;               ///< published in all
  std::size_t wrong_scans = 0;         ///< not measured by the sensor at their stamp
  std::size_t uncounted = 0;           ///< faults without growth of any named counter
  std::size_t late = 0;                ///< faults with a recovery that took longer than allowed
  std::int64_t worst_recovery_ns = 0;  ///< from the fault's end to the next scan
};

/// All known faults for a line at `baud`.
[[nodiscard]] std::vector<PlsFaultTest> pls_fault_tests(std::uint32_t baud);

/// Injects the fault `times` times while the laser sends scans at `baud`. The same seed gives the
/// same result.
[[nodiscard]] PlsFaultResult run_pls_fault(const PlsFaultTest& test, std::uint32_t baud,
                                           std::size_t times, std::uint64_t seed);

}  // namespace topogeo::devices
