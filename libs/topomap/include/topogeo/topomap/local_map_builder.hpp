// Makes the local topo-geometric map from the local Voronoi diagram (Thesis, 5.2;
// docs/algorithms.md, "Local topo-geometric map").
//
// Branches follow the cracks of the diagram, so a branch and its two nodes share its base groups by
// construction and 5.2.1 needs no search. Far points are cut (5.5), states are added where the
// clearance along a branch shows them (5.1-5.4), and the main graph is marked.
//
// Two differences from the Thesis: elements off the main graph are marked instead of removed,
// because matching on everything is more repeatable than on the main graph (`remove_off_main_graph`
// removes them). And nodes and branches whose clearance circle reaches into space outside the
// scan's view are marked: such a node is fictitious, such a stretch of a branch not confirmed. They
// serve navigation, but are no landmarks; both tables are in docs/decisions/perception.md.
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
/// The same into `points`, which keeps its capacity.
void scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser, double range_limit_m,
                 std::vector<ScanPoint>& points);

/// Makes local maps; a reusable work space, so that rebuilding a map in the same object allocates
/// nothing after the first few.
class LocalMapBuilder {
 public:
  /// Throws std::invalid_argument as check(LocalMapConfig).
  explicit LocalMapBuilder(const LocalMapConfig& config);
  ~LocalMapBuilder();
  LocalMapBuilder(LocalMapBuilder&&) noexcept;
  LocalMapBuilder& operator=(LocalMapBuilder&&) noexcept;

  /// Fills `nodes`, `branches`, `points` and `T_robot_laser` of `out` from a scan and its diagram;
  /// the other fields are the caller's. Coordinates are in the robot frame. Every node and branch
  /// of a virtual diagram is virtual.
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
