// The tolerances of all comparisons, in one table, so that they are chosen before a run and not to
// fit its result.
#pragma once

#include <string_view>
#include <vector>

namespace topogeo::reproduce {

struct Tolerance {
  std::string_view experiment;  ///< name; with a * at the end, the beginning of names
  std::string_view value;       ///< the same for the name of the value
  double tolerance = 0.0;       ///< in the unit of the value
  std::string_view reason;
};

const std::vector<Tolerance>& tolerances();

/// The entry of a value; null where it has to be exact.
const Tolerance* find_tolerance(std::string_view experiment, std::string_view value);

/// That of its entry; otherwise 1e-9: counts and statements are exact.
double tolerance_of(std::string_view experiment, std::string_view value);

}  // namespace topogeo::reproduce
