// topogeo compare --loops: the table of revisits and loops.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::cli {

struct LoopComparison {
  std::filesystem::path map;
  std::filesystem::path reference;              ///< TUM
  std::optional<std::filesystem::path> report;  ///< default: report.json beside the map
  geometry::Pose2 T_robot_laser;                ///< the reference describes the laser
  std::int64_t max_apart_ns = 0;
  bool json = false;
};

/// Throws service::BadInputError naming the file that cannot be used.
void print_loops(const LoopComparison& comparison);

}  // namespace topogeo::cli
