// The table of drives by sonars alone, in Markdown.
#pragma once

#include <string>
#include <vector>

#include "sonar_run.hpp"

namespace topogeo::bench {

struct SonarRow {
  std::string floor;
  std::uint64_t run = 0;  ///< with the floor: repeats it
  bool obstacle = false;
  SonarResult result;
};

/// A line for each floor and one for all; then the runs that did not end well, one line each.
std::string sonar_table(const std::vector<SonarRow>& rows);

}  // namespace topogeo::bench
