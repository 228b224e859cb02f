// Parameters of the local Voronoi diagram (spec A1, thesis 4.2).
//
// Defaults are chosen by how many real nodes are found again in a scan half a metre farther on, on
// a simulated floor and three recorded logs together (tests/bench/repeatability.sh, RESULTS.md);
// the shares below are from that table.
#pragma once

namespace topogeo::voronoi {

struct VoronoiConfig {
  /// d_max of 4.1, metres, in [0.5, 100]. Readings beyond it make no group. 10: at 4 m (the
  /// source's value) a third of the nodes of real floors is lost.
  double range_limit_m = 10.0;
  /// Side of a grid cell, metres, in [0.01, 1]. 0.05 is the source's value; points lie on the locus
  /// between the cell centres, so a finer grid resolves narrower gaps rather than moving points.
  double resolution_m = 0.05;
  /// 4.14: the grid covers the extent of the groups along the axes of the laser instead of that of
  /// the free space. Off: where a branch ends would depend on how the laser is turned.
  bool window_of_groups = false;
  /// Direction of the robot's forward motion in the laser frame, radians. 0: the laser looks
  /// forward. Decides what is left and right for hidden zones and for virtual groups.
  double forward_rad = 0.0;
  /// Readings missing over at most this angle between two valid beams are taken for drop-outs (dark
  /// or shiny surfaces) and count as free up to the nearer neighbour, radians. 2 degrees.
  double dropout_rad = 0.035;

  /// 4.7: split where successive ranges differ by more than this, metres. Off: only a missing beam
  /// splits. 0.5: just below the robot's width; less splits what 4.8 joins again.
  bool split_discontinuities = true;
  double discontinuity_m = 0.5;
  /// 4.7 looks at the wall instead of the range alone: successive readings also belong together
  /// where one lies on the line through the two before it or after it, within this, metres (0: as
  /// in the source). At grazing incidence readings of one wall are farther apart than any useful
  /// threshold: 0.9 m at 10 m along a corridor 2 m wide.
  double on_wall_m = 0.05;
  /// 4.8: join successive groups that come nearer than this, metres. Just over the robot's width
  /// (0.525 m), so a gap that the robot cannot pass makes no branch.
  bool join_contiguous = true;
  double contiguous_m = 0.55;
  /// 4.9: join groups k and k+2 that come nearer than this, metres, and drop group k+1. The same
  /// width for the same reason.
  bool join_alternate = true;
  /// 4.9 only where group k+1 is seen through the gap, farther away than both edges. On: the source
  /// also drops what stands in front of a wall, which hides an obstacle, and fewer nodes are found
  /// again (0.75 instead of 0.77; 0.74 without 4.9).
  bool alternate_behind_only = true;
  /// 4.9 only between groups that 4.10 keeps. On: one stray reading in front of a wall would take
  /// the wall away.
  bool alternate_large_only = true;
  double alternate_m = 0.55;
  /// 4.10: drop groups of this many points or fewer. The equation prints "fewer", the text "equal
  /// or below"; the text is followed. 2: a single reading on an edge makes a false branch.
  bool drop_small = true;
  int min_group_points = 2;
  /// 4.8 and 4.9 once more after 4.10 dropped a group. On: a stray reading between two groups keeps
  /// them apart until it is gone, and leaves a branch through a gap that the robot cannot pass.
  bool join_again = true;
  /// 4.11, 4.12: join groups that a corner hides a zone between. Off: it costs half of the nodes,
  /// and of the others 0.58 are found again instead of 0.77.
  bool join_hidden_zones = false;

  /// Sites are put between successive readings of one wall so that none is farther than this from
  /// the next, metres (0: only readings are sites, as in the source); at most 99 between two.
  /// Without it the diagram of two walls seen at grazing incidence weaves between their readings.
  double site_spacing_m = 0.1;

  /// Two nodes joined by a branch no longer than this are one node, metres. 0.15 is three cells:
  /// one crossing of four groups is seen as two crossings of three.
  double node_merge_m = 0.15;
  /// Branches with a loose end that are shorter than this are dropped, metres. Below it they are
  /// crumbs at the border of what is visible.
  double min_branch_m = 0.2;

  /// Half the distance between the virtual groups of a virtual diagram, metres. Over half of the
  /// robot's width, so that the robot can move between them.
  double virtual_half_width_m = 0.6;
};

/// Throws std::invalid_argument that names the first field outside its range.
void validate(const VoronoiConfig& config);

}  // namespace topogeo::voronoi
