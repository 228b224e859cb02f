// The global map as printed in the thesis (Thesis, 7.3.2; docs/algorithms.md, "Global map"): each
// view is joined with the map so far, element by element, and nothing is ever removed.
//
// Kept for comparison: after dozens of views the errors of the poses leave bundles of almost
// parallel branches, and a false branch stays unless a later view replaces it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

namespace topogeo::topomap {

class PairFusion {
 public:
  explicit PairFusion(const GlobalMapConfig& config) : config_(config) {}

  /// Joins one view. Only real elements of its main graph count. Elements in its field of view
  /// (prop. 7.3.3), the rectangle around the robot and its branches, can be equivalent.
  void add(const LocalMap& map, const geometry::Pose2& T_map_robot, const Sighting& sighting);

  /// The current elements, ordered by id.
  [[nodiscard]] GlobalMap map() const;

 private:
  struct View;

  std::uint32_t join_node(const LocalNode& node, View& view);
  void join_branch(MapBranch seen, const View& view);
  [[nodiscard]] bool equivalent(const MapBranch& known, const MapBranch& seen,
                                const View& view) const;
  void keep_outside(std::size_t known, const View& view);
  std::uint32_t add_node(NodeKind kind, const BranchPoint& at, const View& view);
  [[nodiscard]] std::optional<std::size_t> nearest_equivalent(const MapNode& node,
                                                              const View& view) const;

  GlobalMapConfig config_;
  std::vector<MapNode> nodes_;
  std::vector<MapBranch> branches_;
  std::uint32_t next_node_ = 0;
  std::uint32_t next_branch_ = 0;
};

}  // namespace topogeo::topomap
