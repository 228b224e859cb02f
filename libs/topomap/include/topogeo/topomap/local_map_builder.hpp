// From the local Voronoi diagram to the local topo-geometric map (spec A2, thesis 5.2).
//
// Branches follow the cracks of the diagram, so a branch and its two nodes share its base groups by
// construction and 5.2.1 needs no search. Far points are cut (5.5), states are added where the
// clearance along a branch says so (5.1-5.4), and the main graph is marked.
//
// Two things are kept that the source would throw away or take for certain. What is off the main
// graph is marked instead of removed, because matching on everything is more repeatable than on the
// main graph (`remove_off_main_graph` removes it). And nodes and branches whose clearance circle
// reaches into what the scan did not see are told from the others: such a node is fictitious, such
// a stretch of a branch not confirmed. They are ways to go on, but no landmarks; both tables are in
// tests/bench/RESULTS.md.
#pragma once

#include <memory>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::topomap {

struct LocalMapConfig {
  /// Scan points up to this range are kept for matching, metres. More than the diagram's: the far
  /// end of a corridor is all that says how far along it the robot is.
  double points_range_m = 50.0;

  /// Threshold of 5.5, metres: an outer branch ends before the first step longer than this, and two
  /// loose ends of the same base groups nearer than this belong to one graph. A traced branch has
  /// steps of a cell; its far points are a branch of their own, so it is the second that decides.
  /// 0.5: a beam or two missing at some metres leaves less, another room's branch more.
  double separated_m = 0.5;

  /// Largest part of the clearance, [0, 1], by which the circle of a real node or confirmed branch
  /// point may reach into what was not seen (voronoi::Frontier). 1: everything counts as confirmed,
  /// as in the source.
  double largest_hidden_share = 0.2;
  /// Stretches of a branch that are shorter than this count as what lies beside them, metres. 0.2:
  /// four cells, as the shortest branch.
  double min_stretch_m = 0.2;
  /// The graph nearest to the robot is looked for among those with at least this length of
  /// branches, metres. 1: a stub beside the robot is no way to go.
  double min_main_graph_m = 1.0;
  /// Remove what is not connected with the graph nearest to the robot (5.2.2) instead of marking
  /// it. Off: with it 0.90 of the branch points are found again instead of 0.92. Costs allocations.
  bool remove_off_main_graph = false;

  /// Search for states on branches (5.2.2.1).
  bool find_states = true;
  /// Largest clearance of a door, metres. 0.6: half of a wide single door (1.2 m).
  double door_half_width_m = 0.6;
  /// Smallest clearance of a door, metres; a narrower one is a narrowing. 0.275: just over half of
  /// the robot's width (0.525 m).
  double door_min_half_width_m = 0.275;
  /// The clearance must rise by this much on a side of a minimum to count as a change of slope,
  /// metres. 0.1: twice the error of a reading (0.05 m), since a branch point depends on two;
  /// 0.15 and more find fewer states again.
  double state_rise_m = 0.1;
  /// Threshold of 5.4, metres: the point that confirms a change of slope lies farther than this
  /// from it. 0.15, as above.
  double state_confirm_m = 0.15;
  /// The place of a door or narrowing is the minimum of the parabola through the clearances this
  /// far to both sides, metres. 0.35: seven points at 5 cm cells, and no second minimum.
  double state_reach_m = 0.35;
  /// Clearances that differ by no more than this are one plateau, metres. Twice the error of a
  /// reading.
  double plateau_m = 0.1;
  /// A minimum whose plateau is at least this long is a corridor with a passage at each open end, a
  /// shorter one is a door or narrowing, metres. 1.5: no door leaf or pillar is as deep.
  double corridor_length_m = 1.5;
  /// From a corridor to a hall the clearance rises by at least this much, metres. 0.3: more than
  /// the niche of a door.
  double hall_rise_m = 0.3;
};

/// Throws std::invalid_argument that names the first field outside its range: lengths are finite,
/// at least 0 and at most 1000 m, largest_hidden_share is in [0, 1].
void validate(const LocalMapConfig& config);

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
  /// Throws std::invalid_argument if a field of the configuration is outside its range.
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
