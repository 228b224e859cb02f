// Obstacles that the laser has seen in the last seconds and that are not on the map.
//
// The laser looks ahead only, so passed obstacles are kept until they are seen to be gone or
// forgotten. Points near obstacles of the map are their surfaces, seen with the errors of pose and
// laser. A point that stays in its cell for a while stands; others move.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/free_space.hpp"

namespace topogeo::navigation {

struct MemoryConfig {
  double farthest_m = 4.0;       ///< points beyond are ignored
  double tolerance_m = 0.21;     ///< points this near to the map's obstacles belong to them,
  double tolerance_rad = 0.015;  ///< plus this for each metre from the robot
  double stands_s = 0.7;         ///< seen for this long in its cell: it stands
  double forgotten_s = 20.0;     ///< not seen for this long
};

struct Obstacle {
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();  ///< map frame
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  int hits = 0;
  int misses = 0;  ///< since the last hit
  bool stands = false;
};

class ObstacleMemory {
 public:
  explicit ObstacleMemory(const MemoryConfig& config) : config_(config) {}

  /// `T_map_robot` at the time of the scan.
  void add(const ScanPoints& scan, const geometry::Pose2& T_map_robot,
           const planning::FreeSpace& space);
  void clear() { cells_.clear(); }

  /// Obstacles seen at least twice, in the order of the cells.
  [[nodiscard]] std::vector<Obstacle> all() const;

 private:
  MemoryConfig config_;
  std::map<std::size_t, Obstacle> cells_;  ///< by cell index
};

}  // namespace topogeo::navigation
