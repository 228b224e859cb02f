// Takes the noise off the points of a scan.
#pragma once

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

/// Every point moved along its beam to the mean range of the beams beside it that see the same
/// surface, by at most `most_m`. Points that stand alone stay where they are.
ScanPoints smoothed(const ScanPoints& scan, double most_m);

}  // namespace topogeo::navigation
