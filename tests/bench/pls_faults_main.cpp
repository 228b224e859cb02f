// The faults of a laser and its line on a simulated clock, as a table in Markdown: how often each
// was injected, wrong scans, the longest recovery.
#include <cstdint>
#include <exception>
#include <iostream>

#include "devices/pls_faults.hpp"

namespace {

constexpr std::size_t kTimes = 1000;
constexpr std::uint64_t kLaserSeed = 1;

void print_table(std::uint32_t baud) {
  using topogeo::devices::PlsFaultResult;
  using topogeo::devices::PlsFaultTest;
  std::cout << "\n"
            << baud << " baud\n\n"
            << "| fault | times | scans | wrong scans | not counted | worst recovery, ms "
               "| allowed, ms | counted as |\n"
            << "|---|---|---|---|---|---|---|---|\n";
  for (const PlsFaultTest& test : topogeo::devices::pls_fault_tests(baud)) {
    const PlsFaultResult result = topogeo::devices::run_pls_fault(test, baud, kTimes, kLaserSeed);
    const auto ms = [](std::int64_t time_ns) { return time_ns / 1'000'000; };
    std::cout << "| " << test.name << " | " << result.times << " | " << result.scans << " | "
              << result.wrong_scans << " | " << result.uncounted << " | "
              << ms(result.worst_recovery_ns) << " | " << ms(test.allowed_ns) << " | "
              << (test.counted_as.empty() ? "-" : test.counted_as) << " |\n"
              << std::flush;
  }
}

}  // namespace

int main() {
  try {
    for (const std::uint32_t baud : {500'000U, 38400U}) print_table(baud);
  } catch (const std::exception& error) {
    std::cerr << "pls_faults: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
