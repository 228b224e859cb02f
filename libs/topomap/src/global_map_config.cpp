#include "topogeo/topomap/global_map_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::topomap {
namespace {

void describe_votes(GlobalMapConfig& g, support::ConfigSchema& schema) {
  schema.add("global_map.cell_m", &g.cell_m, 0.032, 0.25, "m",
             "side of a cell in which views vote for branches");
  schema.add("global_map.vote_radius_m", &g.vote_radius_m, 0.032, 2.0, "m",
             "radius of the vote of a branch; one to eight cells");
  schema.add("global_map.gap_m", &g.gap_m, 0.01, 5.0, "m",
             "neighbouring scan points further apart than this leave a passage; the space behind "
             "it counts as unseen");
  schema.add("global_map.uncertain_weight", &g.uncertain_weight, 0.0, 1.0, "",
             "weight of the vote of a branch point that unseen obstacles could still move; a "
             "certain point has 1");
  schema.add("global_map.keep_share", &g.keep_share, 0.12, 0.99, "",
             "a place is on a branch if at least this share of the views of the place vote for it");
  schema.add(
      "global_map.bridge_share", &g.bridge_share, 0.01, 0.99, "",
      "a place can link two such places if at least this share vote for it; not above keep_share");
  schema.add("global_map.memory_views", &g.memory_views, 1.0, 1e6, "views",
             "older views fade beyond this many, so that the map follows changes");
  schema.fix(
      {"global_map.vote_radius_m", "global_map.uncertain_weight", "global_map.bridge_share"});
}

void describe_elements(GlobalMapConfig& g, support::ConfigSchema& schema) {
  schema.add("global_map.node_merge_m", &g.node_merge_m, 0.01, 5.0, "m",
             "nodes nearer than this with similar clearances become one");
  schema.add("global_map.clearance_tolerance_m", &g.clearance_tolerance_m, 0.01, 5.0, "m",
             "largest difference between similar clearances");
  schema.add("global_map.min_observations", &g.min_observations, 1U, 1000U, "",
             "views that must have seen an element");
  schema.add("global_map.hole_m2", &g.hole_m2, 0.0, 100.0, "m2",
             "smaller holes between votes are noise, not obstacles that branches go around");
  schema.add("global_map.spur_m", &g.spur_m, 0.0, 10.0, "m",
             "branches with a free end are dropped if they reach less than this beyond the "
             "clearance at their node");
  schema.add("global_map.min_component_m", &g.min_component_m, 0.0, 1e6, "m",
             "separate parts with a smaller total length are dropped");
  schema.add("global_map.join_m", &g.join_m, 0.0, 5.0, "m",
             "longest gap closed between two ends whose free circles overlap");
  schema.fix({"global_map.clearance_tolerance_m", "global_map.hole_m2", "global_map.spur_m",
              "global_map.min_component_m", "global_map.join_m"});
}

}  // namespace

void describe(GlobalMapConfig& config, support::ConfigSchema& schema) {
  schema.add("global_map.fusion", &config.fusion,
             {{"votes", FusionRule::kVotes}, {"pairs", FusionRule::kPairs}},
             "votes: branches are the ridges of the votes of all views; pairs: equivalent nodes "
             "and branches of map and view are joined, as printed in the thesis (eq. 7.25-7.27), "
             "for comparison");
  describe_votes(config, schema);
  describe_elements(config, schema);
}

void check(const GlobalMapConfig& config) {
  constexpr double kMostCells = 8.0;  // the work of a vote grows with the square of its reach
  support::check_ranges(config);
  support::require_between("global_map.vote_radius_m", config.vote_radius_m, config.cell_m,
                           kMostCells * config.cell_m, "m");
  support::require_at_least("global_map.keep_share", config.keep_share, "global_map.bridge_share",
                            config.bridge_share);
}

}  // namespace topogeo::topomap
