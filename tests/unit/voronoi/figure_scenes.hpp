// The scenes of the Thesis's figures (share/figures) and a textual form of their diagrams.
//
// Walls have the letters A, B, C ... in the order of the scene file, columns a, b, c ... A group is
// named by the letters of the surfaces with its points ("BC"), a node and a branch by the groups at
// equal distance ("A|BC|D"). So expectations do not depend on the order of groups and can be
// compared between turned and mirrored scenes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"
#include "topogeo/voronoi/thesis_voronoi.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::figure_scenes {

struct Scene {
  world::World world;
  /// Poses of the laser: each point of the tour, facing x.
  std::vector<geometry::Pose2> T_world_laser;
};

/// Scene of share/figures/figure_<number>.world.yaml.
Scene load_scene(const std::string& number);
/// Numbers of all scenes.
const std::vector<std::string>& scene_numbers();
/// The scene mirrored at the x axis.
Scene mirrored(const Scene& scene);

/// The laser of the Thesis: 361 beams over 180 degrees.
inline simulation::BeamPattern half_turn() {
  return {};
}
/// 720 beams all around, the first to the rear.
simulation::BeamPattern full_turn();

/// Exact readings, no noise.
scan::Scan scan_of(const world::World& world, const geometry::Pose2& T_world_laser,
                   const simulation::BeamPattern& beams = half_turn());

inline voronoi::VoronoiConfig source_config() {
  return voronoi::thesis_voronoi();
}
inline voronoi::VoronoiConfig only_splitting() {
  return voronoi::thesis_splitting_alone();
}

struct NamedNode {
  std::string name;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< laser frame
  double clearance_m = 0.0;
};

/// The nodes of a diagram or map, each with its name.
struct NamedNodes {
  std::vector<NamedNode> nodes;

  [[nodiscard]] std::vector<std::string> node_names() const;  ///< sorted
  /// The node with that name; empty if there is none or more than one.
  [[nodiscard]] std::optional<NamedNode> node(std::string_view name) const;
};

struct Seen : NamedNodes {
  std::vector<std::string> groups;    ///< in beam order; "*" is a virtual group
  std::vector<std::string> branches;  ///< "A|B: A|B|C - open", sorted
  bool is_virtual = false;
};

/// Names of the groups of a diagram that was made at T_world_laser.
std::vector<std::string> group_names(const voronoi::LocalVoronoiDiagram& diagram,
                                     const world::World& world,
                                     const geometry::Pose2& T_world_laser);
/// "A|BC|D" for a list of group indices.
template <typename Groups>
std::string joined_names(const Groups& groups, const std::vector<std::string>& names);

Seen describe(const voronoi::LocalVoronoiDiagram& diagram, const world::World& world,
              const geometry::Pose2& T_world_laser);
/// Diagram of the scene from place `at`, as text.
Seen see(const Scene& scene, const voronoi::VoronoiConfig& config,
         const simulation::BeamPattern& beams = half_turn(), std::size_t at = 0);

/// Expects one node with that name within 3 cm of `position_m`, worked by hand for whole walls.
void expect_node(const NamedNodes& seen, const std::string& name, const Eigen::Vector2d& position_m,
                 double tolerance_m = 0.03);

std::string sorted_joined(std::vector<std::string> names);

template <typename Groups>
std::string joined_names(const Groups& groups, const std::vector<std::string>& names) {
  std::vector<std::string> parts;
  parts.reserve(groups.size());
  for (const auto group : groups) parts.push_back(names[group]);
  return sorted_joined(std::move(parts));
}

}  // namespace topogeo::figure_scenes
