// Relations: hand-checked relative poses of the robot, as text; the measure of Burgard, Stachniss
// et al., "A comparison of SLAM algorithms based on a graph of relations" (docs/file_formats.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::storage {

struct Relation {
  std::int64_t stamp_a_ns = 0;
  std::int64_t stamp_b_ns = 0;
  geometry::Pose2 T_a_b;  ///< pose of the robot at `b` relative to its pose at `a`
};

/// Reads lines "t1 t2 x y z roll pitch yaw", metres, radians, seconds; skips empty ones and those
/// that start with '#', and ignores z, roll and pitch. Throws std::runtime_error naming file and
/// line.
std::vector<Relation> read_relations(const std::filesystem::path& path);
std::vector<Relation> parse_relations(std::string_view text, const std::string& name);

}  // namespace topogeo::storage
