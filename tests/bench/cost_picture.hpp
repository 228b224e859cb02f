// A picture of the cost of each step along a log.
#pragma once

#include <string>
#include <vector>

namespace topogeo::bench {

struct StepCost {
  double path_m = 0.0;  ///< driven so far
  double cpu_ms = 0.0;
};

/// Dots for the steps, lines for median and 95th percentile of windows of 100, over the path; the
/// cost on a logarithmic axis. PNG. Throws std::invalid_argument without steps, std::runtime_error
/// when the file cannot be written.
void draw_costs(const std::string& file, const std::string& title,
                const std::vector<StepCost>& steps);

}  // namespace topogeo::bench
