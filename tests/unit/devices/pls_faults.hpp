// Faults of a laser and its line, injected many times on a simulated clock, and what became of
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace topogeo::devices {

struct PlsFaultTest {
  std::string name;
  std::string counted_as;       ///< the counters of which one must grow with every fault
  std::int64_t allowed_ns = 0;  ///< longest recovery
};

struct PlsFaultResult {
  std::size_t times = 0;
  std::size_t scans = 0;        ///< handed on in all
  std::size_t wrong_scans = 0;  ///< handed on though the sensor did not measure them then
  std::size_t uncounted = 0;    ///< faults after which no counter named in the test had grown
  std::size_t late = 0;         ///< faults from which the recovery took longer than allowed
  std::int64_t worst_recovery_ns = 0;  ///< from the fault's end to the next scan handed on
};

/// All that are known, for a line at `baud`.
[[nodiscard]] std::vector<PlsFaultTest> pls_fault_tests(std::uint32_t baud);

/// Injects the fault `times` times while the laser sends scans at `baud`. The same seed gives the
/// same result.
[[nodiscard]] PlsFaultResult run_pls_fault(const PlsFaultTest& test, std::uint32_t baud,
                                           std::size_t times, std::uint64_t seed);

}  // namespace topogeo::devices
