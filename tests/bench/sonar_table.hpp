// The table of drives with sonars alone, in Markdown.
#pragma once

#include <string>
#include <vector>

#include "sonar_run.hpp"

namespace topogeo::bench {

struct SonarRow {
  std::string floor;
  std::uint64_t run = 0;  ///< repeats the run, together with the floor
  bool obstacle = false;
  SonarResult result;
};

/// A line for each floor and one for all; then a line for each run that did not end well.
std::string sonar_table(const std::vector<SonarRow>& rows);

}  // namespace topogeo::bench
