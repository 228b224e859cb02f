// Fuses local maps into the global topo-geometric map (Thesis, 7.3.2; docs/algorithms.md,
// "Global map").
//
// The Thesis joins branches pair by pair (7.27), which after dozens of overlapping views leaves a
// bundle of almost parallel lines. Here each view votes instead, in a sparse grid over the map
// frame: for the places that its branches pass, and against branches of earlier views that lie well
// inside its field of view but that it did not see. The map is the ridge of the votes, so a branch
// is the mean of all views that saw it, a door seen open later adds its branch (fig. 8.9), and a
// false branch loses to views that look well into its place and do not have it. Where few views do,
// as behind the leaf of fig. 8.8, it stays. Nodes are fused as in the Thesis: equivalent ones merge
// to the mean of position (7.25) and clearance (7.26), neighbouring ones collapse (fig. 8.10). The
// trade-off: branches closer together than about twice `vote_radius_m` become one. `fusion: pairs`
// joins as printed in the Thesis, for comparison.
//
// If the robot drove from one part of the map to another without seeing a connection (local maps
// that do not overlap, fig. 8.23), a virtual branch along the driven path connects them. It serves
// navigation; matching never uses the global map.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/global_map_config.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::topomap {

/// The views that a local map stands for.
struct Sighting {
  std::uint32_t views = 1;
  std::int64_t last_ns = 0;  ///< stamp of the last view
};

/// The fused map. Its state depends only on the sequence of integrated maps and poses.
class GlobalMapBuilder {
 public:
  /// Throws std::invalid_argument as `check` does.
  explicit GlobalMapBuilder(const GlobalMapConfig& config = {});
  GlobalMapBuilder(GlobalMapBuilder&&) noexcept;
  GlobalMapBuilder& operator=(GlobalMapBuilder&&) noexcept;
  ~GlobalMapBuilder();

  /// Adds one local map seen from T_map_robot. Only real (not virtual) elements of its main graph
  /// are fused. Throws std::invalid_argument if the pose is not finite or more than 5 km from the
  /// origin, or a coordinate of the map not finite or more than 500 m from the robot; the state is
  /// then unchanged.
  void integrate(const LocalMap& map, const geometry::Pose2& T_map_robot);
  /// The same for a view that stands for others, too: they count as observations of its elements.
  void integrate(const LocalMap& map, const StopPose& stop);

  /// The same state as a new builder after integrating maps[i] at poses[i] in order. Throws
  /// std::invalid_argument if the numbers differ, or as `integrate` does.
  void rebuild(std::span<const LocalMap> maps, std::span<const StopPose> poses);

  /// The current map, labelled `version`. Nodes and branches keep their ids between snapshots as
  /// long as they stay at their place. Fictitious nodes are free branch ends. Virtual branches are
  /// the links of virtual_links.hpp, virtual nodes the places where a link meets the middle of a
  /// branch. A map whose id is the next one follows the map integrated before it, and its track is
  /// the path between them.
  [[nodiscard]] GlobalMap snapshot(std::uint64_t version) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace topogeo::topomap
