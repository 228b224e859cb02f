// The odometry that belongs to scans: what the gateway keeps of the base's reports.
#pragma once

#include "topogeo/geometry/odometry_track.hpp"

namespace topogeo::sensor_gateway {

using geometry::OdometrySample;
using geometry::OdometryTrack;

}  // namespace topogeo::sensor_gateway
