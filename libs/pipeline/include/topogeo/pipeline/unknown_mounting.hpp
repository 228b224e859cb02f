// An unknown mounting of the laser, found from the scans before mapping begins.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "topogeo/calibration/mounting_search.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::pipeline {

/// Searches with the scans that `next` returns in time order, until there are motions enough or it
/// returns none. The mounting in `config` does not matter.
localization::FoundMounting find_mounting(const std::function<std::optional<scan::Scan>()>& next,
                                          const Config& config);

/// One line for the user: what was found, how surely, and the flag for what was not.
std::string text_of(const localization::FoundMounting& found);

/// A warning for the user if the scans clearly show another heading than the stated mounting, or a
/// laser upside down; otherwise empty. `found` is by scans that were read as stated.
std::string contradiction(const localization::FoundMounting& found,
                          const geometry::Pose2& T_robot_laser);

/// Why such a log cannot be mapped as stated, with the flags that decide, if the scans fit the
/// odometry only as mirrored: a laser whose beams are reversed looks like odometry that turns the
/// wrong way, and a map of the one would be the mirror image of a map of the other. Otherwise
/// empty.
std::string mirroring(const localization::FoundMounting& found);

}  // namespace topogeo::pipeline
