// From the local Voronoi diagram to the local topo-geometric map (Thesis, 5.2;
// docs/algorithms.md, "Local topo-geometric map").
//
// Branches follow the cracks of the diagram, so a branch and its two nodes share its base groups by
// construction and 5.2.1 needs no search. Far points are cut (5.5), states are added where the
// clearance along a branch shows them (5.1-5.4), and the main graph is marked.
//
// Two things are kept that the Thesis would throw away or take for certain. What is off the main
// graph is marked instead of removed, because matching on everything is more repeatable than on the
// main graph (`remove_off_main_graph` removes it). And nodes and branches whose clearance circle
// reaches into what the scan did not see are marked: such a node is fictitious, such
// a stretch of a branch not confirmed. They serve navigation, but are no landmarks; both tables are
// in tests/bench/RESULTS.md.
#pragma once

#include <memory>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/local_map_config.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::topomap {

/// Points of the echoes up to `range_limit_m`, in beam order, in the robot frame.
std::vector<ScanPoint> scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser,
                                   double range_limit_m);
/// The same into `points`, which keeps its memory.
void scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser, double range_limit_m,
                 std::vector<ScanPoint>& points);

/// Makes local maps; a reusable work space, so that once it is warm a map that is built into the
/// same object again costs no allocation.
class LocalMapBuilder {
 public:
  /// Throws std::invalid_argument as check(LocalMapConfig).
  explicit LocalMapBuilder(const LocalMapConfig& config);
  ~LocalMapBuilder();
  LocalMapBuilder(LocalMapBuilder&&) noexcept;
  LocalMapBuilder& operator=(LocalMapBuilder&&) noexcept;

  /// Fills `nodes`, `branches`, `points` and `T_robot_laser` of `out` from a diagram and the scan
  /// that it was made of; the other fields are the caller's. Coordinates are in the robot frame. Of
  /// a virtual diagram every node and branch is virtual.
  void build(const voronoi::LocalVoronoiDiagram& diagram, const scan::Scan& scan,
             const geometry::Pose2& T_robot_laser, LocalMap& out);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// The same once, without a work space.
void build_local_map(const voronoi::LocalVoronoiDiagram& diagram, const scan::Scan& scan,
                     const geometry::Pose2& T_robot_laser, const LocalMapConfig& config,
                     LocalMap& out);

}  // namespace topogeo::topomap
