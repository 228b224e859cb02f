// Local maps of the figure scenes in words: "door A|B", "A|B: real A|B|C - fictitious A|B".
// Elements off the main graph end with " (off)". Groups have the names of figure_scenes.hpp.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/topomap/thesis_local_map.hpp"

#include "voronoi/figure_scenes.hpp"

namespace topogeo::figure_scenes {

inline topomap::LocalMapConfig source_map_config() {
  return topomap::thesis_local_map();
}

struct MapSeen : NamedNodes {         // names like "real A|B|C"
  std::vector<std::string> branches;  ///< sorted
};

/// Expects a well-formed map whose elements are all virtual for a virtual diagram, and else none.
void expect_well_formed(const topomap::LocalMap& map, bool is_virtual);

MapSeen describe(const topomap::LocalMap& map, const std::vector<std::string>& group_names);

/// A diagram and the local map made of it, laser at the robot's origin unless `T_robot_laser` is
/// given.
struct Made {
  voronoi::LocalVoronoiDiagram diagram;
  topomap::LocalMap map;
};
Made make_map(const scan::Scan& scan, const voronoi::VoronoiConfig& config,
              const topomap::LocalMapConfig& map_config, const geometry::Pose2& T_robot_laser = {});

/// Local map of the scene from place `at`, as text.
MapSeen see_map(const Scene& scene, const voronoi::VoronoiConfig& config,
                const topomap::LocalMapConfig& map_config,
                const simulation::BeamPattern& beams = half_turn(), std::size_t at = 0);

}  // namespace topogeo::figure_scenes
