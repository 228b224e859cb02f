// A quantile of measured times.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace topogeo::bench {

/// The value at `share`, [0, 1], of the sorted values; needs at least one value.
inline double sample_quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace topogeo::bench
