// Removes noise from the points of a scan.
#pragma once

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

/// Moves every point along its beam to the mean range of neighbouring beams on the same surface, by
/// at most `most_m`. Isolated points stay.
ScanPoints smoothed(const ScanPoints& scan, double most_m);

}  // namespace topogeo::navigation
