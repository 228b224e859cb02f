// An unknown mounting of the laser, found from the scans before mapping begins.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/calibration/mounting_search.hpp"
#include "topogeo/calibration/scan_delay.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/scan_feed.hpp"

namespace topogeo::pipeline {

/// Motions of robot and laser, in time order: of the first 60 m or so, and samples of the rest.
struct DriveMotions {
  std::vector<localization::LaserMotion> motions;
  std::int64_t first_ns = 0;  ///< stamp of the first scan
};

/// The motions of the scans that `next` returns in time order. The mounting in `config` does not
/// matter.
DriveMotions laser_motions(const NextScan& next, const Config& config);

/// The mounting by the motions of the beginning.
localization::FoundMounting find_mounting(const DriveMotions& drive);

/// One line for the user: what was found, how surely, and the flag for what was not.
std::string text_of(const localization::FoundMounting& found);

/// One line for the user about a delay that is taken out.
std::string text_of(const localization::ScanDelay& delay);

/// A warning for the user if the scans clearly show another heading than the stated mounting, or a
/// laser upside down; otherwise empty. `found` is by scans that were read as stated.
std::string contradiction(const localization::FoundMounting& found,
                          const geometry::Pose2& T_robot_laser);

/// Why such a log cannot be mapped as stated, with the flags that decide, if the scans fit the
/// odometry only as mirrored: a laser whose beams are reversed looks like odometry that turns the
/// wrong way, and a map of the one would be the mirror image of a map of the other. Otherwise
/// empty.
std::string mirroring(const localization::FoundMounting& found);

/// Why such a log cannot be mapped as stated, with the flags that decide, if the scans fit the
/// odometry only with another heading of the laser, which puts it elsewhere by more than 0.1 m;
/// otherwise empty. `found` is by scans that were read as stated.
std::string other_heading(const localization::FoundMounting& found,
                          const geometry::Pose2& T_robot_laser);

/// Why such a log cannot be mapped with one mounting, and how it can, if later motions show another
/// one than those before; otherwise empty. `found` is that of the beginning.
std::string changing(const DriveMotions& drive, const localization::FoundMounting& found);

}  // namespace topogeo::pipeline
