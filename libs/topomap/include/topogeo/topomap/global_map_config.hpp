// Settings of the global map, which local maps are fused into.
#pragma once

#include <cstdint>

namespace topogeo::topomap {

struct GlobalMapConfig {
  double cell_m = 0.1;                 ///< side of a vote cell, [0.02, 0.5]
  double vote_radius_m = 0.25;         ///< reach of a branch's vote, [1, 8] cells
  double gap_m = 0.6;                  ///< neighbouring scan points further apart than this leave a
                                       ///< passage, behind which nothing is known, (0, 5]
  double node_merge_m = 0.5;           ///< nodes nearer than this can be equivalent, (0, 5]
  double clearance_tolerance_m = 0.4;  ///< and if their clearances differ by less, (0, 5]
  double uncertain_weight = 0.25;      ///< vote of a branch point that something unseen could still
                                       ///< move, against 1 for a certain one, [0, 1]
  double keep_share = 0.4;             ///< share of votes from which a place is on a branch, (0, 1]
  double bridge_share = 0.12;          ///< share from which it can link two such places, (0, 1]
  double memory_views = 20.0;          ///< older views fade beyond this many, >= 1
  std::uint32_t min_observations = 1;  ///< views that must have seen an element, >= 1
  double spur_m = 0.6;                 ///< branches with a free end that reach less than this
                                       ///< beyond the clearance at their node are dropped, [0, 10]
  double min_component_m = 1.0;  ///< total length below which a separate part is dropped, >= 0
  double join_m = 1.0;           ///< longest gap closed between two ends whose free circles
                                 ///< overlap, [0, 5]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const GlobalMapConfig& config);

}  // namespace topogeo::topomap
