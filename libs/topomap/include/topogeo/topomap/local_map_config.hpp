// Settings of the local topo-geometric map.
#pragma once

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

}  // namespace topogeo::topomap
