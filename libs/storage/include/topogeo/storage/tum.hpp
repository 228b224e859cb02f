// Trajectories as text in the TUM form: one line "t x y z qx qy qz qw" for each pose.
//
// The text is the same bytes on every machine: stamps are printed from integers, sine and cosine
// come from the portable functions, the number of decimals is fixed (positions to 1 um, quaternions
// to 1e-9).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::storage {

/// Seconds with nine decimals, or with six if the last three are zero.
std::string stamp_text(std::int64_t stamp_ns);

/// The text of the file.
std::string trajectory_tum(std::span<const topomap::StampedPose> poses);

/// Writes the file whole or not at all. Throws std::runtime_error naming the path, and
/// std::invalid_argument for a pose that is not finite.
void write_trajectory_tum(const std::filesystem::path& path,
                          std::span<const topomap::StampedPose> poses);

/// Poses in the order of the file, with `sequence` counting from 0. Skips lines that are empty or
/// start with '#'; ignores z, tilt and digits of a stamp below 1 ns. Throws std::runtime_error
/// naming file and line.
std::vector<topomap::StampedPose> read_trajectory_tum(const std::filesystem::path& path);
std::vector<topomap::StampedPose> parse_trajectory_tum(std::string_view text,
                                                       const std::string& name);

}  // namespace topogeo::storage
