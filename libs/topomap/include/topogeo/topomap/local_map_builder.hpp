// From the local Voronoi diagram to the local topo-geometric map (spec A2, thesis 5.2).
//
// Branches follow the cracks of the diagram, so a branch and its two nodes share its base groups by
// construction and 5.2.1 needs no search. Far points are cut (5.5), states are added where the
// clearance along a branch says so (5.1-5.4), and the main graph is marked; nothing off the main
// graph is thrown away, because matching on everything is more repeatable than matching on the main
// graph.
#pragma once

#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::topomap {

struct LocalMapConfig {
  /// Scan points up to this range are kept for matching, metres. The range limit of the diagram.
  double range_limit_m = 10.0;

  /// Threshold of 5.5, metres: an outer branch ends before the first step longer than this, and two
  /// loose ends of the same base groups nearer than this belong to one graph. 0.5: a beam or two
  /// missing at some metres leaves less, another room's branch more.
  double separated_m = 0.5;

  /// Search for states on branches (5.2.2.1).
  bool find_states = true;
  /// Largest clearance of a door, metres. 0.6: half of a wide single door (1.2 m).
  double door_half_width_m = 0.6;
  /// The clearance must rise by this much on a side of a minimum to count as a change of slope,
  /// metres. 0.15: three times the error of a reading (0.05 m), since a branch point depends on
  /// two.
  double state_rise_m = 0.15;
  /// Threshold of 5.4, metres: the point that confirms a change of slope lies farther than this
  /// from it. 0.15, as above.
  double state_confirm_m = 0.15;
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

/// Points of the echoes up to `range_limit_m`, in beam order, in the robot frame.
std::vector<ScanPoint> scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser,
                                   double range_limit_m);

/// Fills `nodes`, `branches`, `points` and `T_robot_laser` of `out` from a diagram and the scan
/// that it was made of; the other fields are the caller's. Coordinates are in the robot frame. Of a
/// virtual diagram every node and branch is virtual.
void build_local_map(const voronoi::LocalVoronoiDiagram& diagram, const scan::Scan& scan,
                     const geometry::Pose2& T_robot_laser, const LocalMapConfig& config,
                     LocalMap& out);

}  // namespace topogeo::topomap
