// A laser that somebody turns on its robot during a drive: each stretch of it shows another
// mounting.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "topogeo/calibration/mounting_search.hpp"

namespace topogeo::localization {

struct MountingChange {
  FoundMounting before;
  FoundMounting after;
  std::int64_t stamp_ns = 0;  ///< of the scans, within some metres of the change
};

/// Searches the mounting in overlapping stretches of the motions, which are in time order, unless
/// `found`, the mounting of all or of the first of them, fits at least half of each stretch. A
/// change is found if two stretches before it agree, and two after it agree on another heading or
/// on the other side of the laser; empty otherwise. Changes of less than
/// FoundMounting::kOtherHeading_rad are not found.
std::optional<MountingChange> find_mounting_change(std::span<const LaserMotion> motions,
                                                   const FoundMounting& found);

}  // namespace topogeo::localization
