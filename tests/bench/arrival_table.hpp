// Tables of simulated drives to goals, in Markdown.
#pragma once

#include <string>
#include <vector>

#include "arrival_run.hpp"

namespace topogeo::bench {

struct ArrivalRow {
  std::string floor;
  std::uint64_t run = 0;  ///< repeats the run, together with the floor
  ObstacleKind obstacle = ObstacleKind::kNone;
  ArrivalResult result;
};

/// A line for each floor, with and without an obstacle, and one for all together; then a line for
/// each run that did not end well.
std::string arrival_table(const std::vector<ArrivalRow>& rows);

}  // namespace topogeo::bench
