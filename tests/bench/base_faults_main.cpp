// The faults of a base and its line on a simulated clock, as a table in Markdown: how often each
// was injected, wrong odometry, unsafe motion, the longest recovery.
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iomanip>
#include <iostream>

#include "devices/base_faults.hpp"

namespace {

using topogeo::devices::BaseDialect;
using topogeo::devices::BaseFaultLine;
using topogeo::devices::BaseFaultResult;
using topogeo::devices::BaseFaultTest;

constexpr std::size_t kBaseTimes = 1000;
constexpr std::uint64_t kBaseSeed = 1;
constexpr std::array kLines{BaseFaultLine{BaseDialect::kAscii, 9600},
                            BaseFaultLine{BaseDialect::kBinary, 38400}};

void print_table(const BaseFaultLine& line) {
  std::cout << "\n"
            << (line.dialect == BaseDialect::kAscii ? "ASCII" : "binary") << " dialect, "
            << line.baud << " baud\n\n"
            << "| fault | times | odometry | wrong | worst error, m | not counted | unsafe "
               "| worst recovery, ms | allowed, ms | counted as |\n"
            << "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const BaseFaultTest& test : topogeo::devices::base_fault_tests(line)) {
    const BaseFaultResult result =
        topogeo::devices::run_base_fault(test, line, kBaseTimes, kBaseSeed);
    const auto ms = [](std::int64_t time_ns) { return time_ns / 1'000'000; };
    std::cout << "| " << test.name << " | " << result.times << " | " << result.odometries << " | "
              << result.wrong << " | " << std::fixed << std::setprecision(3) << result.worst_m
              << " | " << result.uncounted << " | " << result.unsafe << " | "
              << ms(result.worst_recovery_ns) << " | " << ms(test.allowed_ns) << " | "
              << (test.counted_as.empty() ? "-" : test.counted_as) << " |\n"
              << std::flush;
  }
}

}  // namespace

int main() {
  try {
    for (const BaseFaultLine& line : kLines) print_table(line);
  } catch (const std::exception& error) {
    std::cerr << "base_faults: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
