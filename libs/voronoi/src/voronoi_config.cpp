#include "topogeo/voronoi/voronoi_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::voronoi {
namespace {

using support::ConfigSchema;

void describe_diagram(VoronoiConfig& v, ConfigSchema& schema) {
  schema.add("local_map.range_limit_m", &v.range_limit_m, 0.5, 100.0, "m",
             "readings beyond it are left out of the diagram (d_max of the thesis, 4.1); 8 to 10 "
             "gives far richer maps than the 4 m of the thesis");
  schema.add("local_map.resolution_m", &v.resolution_m, 0.01, 1.0, "m",
             "side of a grid cell under the Voronoi diagram; a finer grid resolves narrower gaps "
             "but moves no points");
  schema.add("local_map.window_of_groups", &v.window_of_groups,
             "eq. 4.14: the grid covers only the extent of the groups; branches may end earlier, "
             "depending on how the laser is turned");
  schema.add("local_map.dropout_rad", &v.dropout_rad, 0.0, 0.5, "rad",
             "readings missing over at most this angle are drop-outs on dark or shiny surfaces: "
             "the space up to the nearer neighbour is free");
}

void describe_grouping(VoronoiConfig& v, ConfigSchema& schema) {
  schema.add("local_map.split_discontinuities", &v.split_discontinuities,
             "grouping step of eq. 4.7; false: only a missing beam splits a group");
  schema.add("local_map.discontinuity_m", &v.discontinuity_m, 0.0, 100.0, "m",
             "eq. 4.7: successive ranges that differ by more belong to two objects; just below the "
             "robot's width, because a smaller value splits what eq. 4.8 joins again");
  schema.add("local_map.on_wall_m", &v.on_wall_m, 0.0, 1.0, "m",
             "eq. 4.7: readings on one line within this tolerance belong together however far "
             "apart they are, for example on walls seen at grazing incidence; 0: as in the thesis");
  schema.add("local_map.site_spacing_m", &v.site_spacing_m, 0.0, 10.0, "m",
             "spacing of extra sites on a wall between its readings, so that the diagram of two "
             "walls does not weave between their readings; 0: only readings are sites");
  schema.add("local_map.join_contiguous", &v.join_contiguous, "grouping step of eq. 4.8");
  schema.add("local_map.contiguous_m", &v.contiguous_m, 0.0, 100.0, "m",
             "eq. 4.8: gaps too narrow for the robot make no branch; just over its width");
  schema.add("local_map.join_alternate", &v.join_alternate, "grouping step of eq. 4.9");
  schema.add("local_map.alternate_m", &v.alternate_m, 0.0, 100.0, "m",
             "eq. 4.9: as eq. 4.8, for groups k and k+2; group k+1 is dropped");
  schema.add("local_map.alternate_behind_only", &v.alternate_behind_only,
             "eq. 4.9 applies only if the middle group lies behind the gap, so that no obstacle in "
             "front of a wall is hidden; false: as in the thesis");
  schema.add("local_map.alternate_large_only", &v.alternate_large_only,
             "eq. 4.9 applies only between groups that eq. 4.10 keeps, so that no stray reading "
             "removes a wall");
  schema.add("local_map.drop_small", &v.drop_small, "grouping step of eq. 4.10");
  schema.add("local_map.min_group_points", &v.min_group_points, 0, 1000, "points",
             "eq. 4.10: groups of this many points or fewer are dropped, because a single reading "
             "on an edge makes a false branch");
  schema.add("local_map.join_again", &v.join_again,
             "eqs. 4.8 and 4.9 apply once more after eq. 4.10, so that a dropped reading does not "
             "separate groups");
  schema.add("local_map.join_hidden_zones", &v.join_hidden_zones,
             "grouping step of eqs. 4.11 and 4.12; it costs half of the nodes on real floors");
}

void describe_result(VoronoiConfig& v, ConfigSchema& schema) {
  schema.add("local_map.node_merge_m", &v.node_merge_m, 0.0, 10.0, "m",
             "nodes joined by a branch of at most this length become one node, because a crossing "
             "of four groups is seen as two crossings of three");
  schema.add("local_map.min_branch_m", &v.min_branch_m, 0.0, 10.0, "m",
             "branches with a loose end are dropped if they are shorter than this");
  schema.add(
      "local_map.virtual_half_width_m", &v.virtual_half_width_m, 0.05, 10.0, "m",
      "half of the distance between two virtual groups; more than half of the robot's width");
}

}  // namespace

void describe(VoronoiConfig& config, ConfigSchema& schema) {
  describe_diagram(config, schema);
  describe_grouping(config, schema);
  describe_result(config, schema);
}

void check(const VoronoiConfig& config) {
  support::check_ranges(config);
  // Tables of all cells take hundreds of megabytes beyond 16 million cells.
  support::require_between("local_map.range_limit_m / local_map.resolution_m",
                           config.range_limit_m / config.resolution_m, 2.0, 2000.0, "cells");
  support::require_between("forward_rad", config.forward_rad, -6.3, 6.3, "rad");
}

}  // namespace topogeo::voronoi
