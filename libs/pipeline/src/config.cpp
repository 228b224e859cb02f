#include "topogeo/pipeline/config.hpp"

#include <stdexcept>

#include "config_hybrid_map.hpp"
#include "config_navigator.hpp"

namespace topogeo::pipeline {
namespace {

using support::ConfigSchema;

void describe_scan(Config& c, ConfigSchema& schema) {
  schema.add(
      "scan.range_max_m", &c.log.range_max_m, 0.5, 1000.0, "m",
      "readings at or above it mean that nothing came back; 50 to 82 by sensor in known logs");
  schema.add("laser.x_m", &c.local_mapper.T_robot_laser.x_m, -5.0, 5.0, "m",
             "mounting of the laser on the robot, forward of the point that odometry speaks of");
  schema.add("laser.y_m", &c.local_mapper.T_robot_laser.y_m, -5.0, 5.0, "m",
             "the same, to the left");
  schema.add("laser.yaw_rad", &c.local_mapper.T_robot_laser.theta_rad, -3.1415, 3.1415, "rad",
             "the same, counter-clockwise; 0: the laser looks forward");
}

void describe_local_map(Config& c, ConfigSchema& schema) {
  LocalMapperConfig& m = c.local_mapper;
  schema.add(
      "stop.distance_m", &m.stop_distance_m, 0.1, 10.0, "m",
      "way after which a stop is made; shorter: more maps, more work, better in poor odometry");
  schema.add("stop.turn_rad", &m.stop_turn_rad, 0.05, 3.14, "rad",
             "turn after which a stop is made");
  schema.add("stop.longest_track", &m.longest_track, 1U, 256U, "scans",
             "scans after which a stop is made even if the robot stands");
  schema.add("local_map.range_limit_m", &m.voronoi.range_limit_m, 0.5, 100.0, "m",
             "of the diagram; 8 to 10 gives far richer maps than the source's 4");
  schema.add("local_map.points_range_m", &m.local_map.points_range_m, 0.5, 80.0, "m",
             "readings beyond it are not matched; the far end of a corridor says where along it");
  schema.add("local_map.resolution_m", &m.voronoi.resolution_m, 0.01, 1.0, "m",
             "cell of the grid under the Voronoi diagram");
  schema.add("local_map.window_of_groups", &m.voronoi.window_of_groups,
             "4.14: the grid covers the extent of the groups only; branches may end earlier");
  schema.add("local_map.dropout_rad", &m.voronoi.dropout_rad, 0.0, 0.5, "rad",
             "missing readings over at most this angle are taken for drop-outs");
  schema.add("local_map.split_discontinuities", &m.voronoi.split_discontinuities,
             "grouping step 4.7");
  schema.add("local_map.discontinuity_m", &m.voronoi.discontinuity_m, 0.0, 100.0, "m",
             "4.7: successive ranges that differ by more belong to two objects");
  schema.add("local_map.on_wall_m", &m.voronoi.on_wall_m, 0.0, 1.0, "m",
             "4.7: readings on one line within this belong together however far apart they are; 0: "
             "as in the source");
  schema.add("local_map.site_spacing_m", &m.voronoi.site_spacing_m, 0.0, 10.0, "m",
             "a wall between its readings counts as seen every so often; 0: only readings count");
  schema.add("local_map.join_contiguous", &m.voronoi.join_contiguous, "grouping step 4.8");
  schema.add("local_map.contiguous_m", &m.voronoi.contiguous_m, 0.0, 100.0, "m",
             "4.8: gaps that the robot does not pass make no branch; just over its width");
  schema.add("local_map.join_alternate", &m.voronoi.join_alternate, "grouping step 4.9");
  schema.add("local_map.alternate_m", &m.voronoi.alternate_m, 0.0, 100.0, "m",
             "4.9: the same for groups k, k+2");
  schema.add("local_map.alternate_behind_only", &m.voronoi.alternate_behind_only,
             "4.9 only where the group between lies behind the gap; off: as in the source");
  schema.add("local_map.alternate_large_only", &m.voronoi.alternate_large_only,
             "4.9 only between groups that 4.10 keeps, so that no stray reading takes a wall away");
  schema.add("local_map.drop_small", &m.voronoi.drop_small, "grouping step 4.10");
  schema.add("local_map.min_group_points", &m.voronoi.min_group_points, 0, 1000, "points",
             "4.10: groups of this many points or fewer are dropped");
  schema.add("local_map.join_again", &m.voronoi.join_again,
             "4.8 and 4.9 once more after 4.10: a dropped reading keeps no groups apart");
  schema.add("local_map.join_hidden_zones", &m.voronoi.join_hidden_zones,
             "grouping step 4.11; costs half of the nodes on real floors");
  schema.add("local_map.node_merge_m", &m.voronoi.node_merge_m, 0.0, 10.0, "m",
             "nodes that a branch no longer than this joins are one node");
  schema.add("local_map.min_branch_m", &m.voronoi.min_branch_m, 0.0, 10.0, "m",
             "branches with a loose end shorter than this are dropped");
  schema.add("local_map.virtual_half_width_m", &m.voronoi.virtual_half_width_m, 0.05, 10.0, "m",
             "half the distance between two virtual groups; over half of the robot's width");
  schema.add("local_map.largest_hidden_share", &m.local_map.largest_hidden_share, 0.0, 1.0, "",
             "part of the clearance by which the circle of a real node or confirmed branch may "
             "reach into what was not seen; 1: all are real, as in the source");
  schema.add("local_map.min_stretch_m", &m.local_map.min_stretch_m, 0.0, 10.0, "m",
             "shorter stretches of a branch, confirmed or not, count as what is around them");
  schema.add(
      "local_map.min_main_graph_m", &m.local_map.min_main_graph_m, 0.0, 100.0, "m",
      "5.2.2: graphs with less length of branches are not the main graph if others are there");
  schema.add("local_map.remove_off_main_graph", &m.local_map.remove_off_main_graph,
             "5.2.2: what is off the graph nearest to the robot is removed instead of marked");
  schema.add("local_map.find_states", &m.local_map.find_states,
             "5.2.2.1: doors, narrowings and hall-corridor passages along branches");
  schema.add("local_map.state_rise_m", &m.local_map.state_rise_m, 0.01, 10.0, "m",
             "5.3: rise of the clearance on a side of a minimum that counts as a change of slope");
  schema.add("local_map.state_confirm_m", &m.local_map.state_confirm_m, 0.0, 10.0, "m",
             "5.4: the point that confirms a change of slope lies farther than this from it");
  schema.add("local_map.state_reach_m", &m.local_map.state_reach_m, 0.0, 10.0, "m",
             "way to both sides over which the exact place of a door or narrowing is fitted");
  schema.add("local_map.plateau_m", &m.local_map.plateau_m, 0.0, 10.0, "m",
             "clearances that differ by no more than this are one plateau");
  schema.add("local_map.corridor_length_m", &m.local_map.corridor_length_m, 0.1, 100.0, "m",
             "a plateau at least this long is a corridor, a shorter one a door or narrowing");
  schema.add("local_map.hall_rise_m", &m.local_map.hall_rise_m, 0.01, 10.0, "m",
             "rise of the clearance from a corridor to a hall");
  schema.add("local_map.door_half_width_m", &m.local_map.door_half_width_m, 0.1, 5.0, "m",
             "minima of clearance up to this are doors, wider ones narrowings");
  schema.add("local_map.door_min_half_width_m", &m.local_map.door_min_half_width_m, 0.0, 5.0, "m",
             "a minimum of clearance below this is a narrowing: the robot does not fit through");
  schema.add("local_map.separated_m", &m.local_map.separated_m, 0.05, 10.0, "m",
             "5.5: loose ends of the same groups nearer than this are one branch not seen whole");
}

void describe_odometry(Config& c, ConfigSchema& schema) {
  localization::OdometryNoise& n = c.localizer.odometry;
  schema.add("odometry.translation_m2_per_m", &n.translation_m2_per_m, 1e-6, 1.0, "m2/m",
             "variance along the way for each metre of it");
  schema.add("odometry.lateral_m2_per_m", &n.lateral_m2_per_m, 1e-6, 1.0, "m2/m",
             "variance across the way for each metre of it");
  schema.add("odometry.translation_m2_per_rad", &n.translation_m2_per_rad, 0.0, 1.0, "m2/rad",
             "variance of position for each radian of turn");
  schema.add(
      "odometry.heading_rad2_per_m", &n.heading_rad2_per_m, 1e-6, 1.0, "rad2/m",
      "variance of heading for each metre; too small is the worst mistake, so it is generous");
  schema.add("odometry.heading_rad2_per_rad", &n.heading_rad2_per_rad, 1e-6, 1.0, "rad2/rad",
             "variance of heading for each radian of turn");
}

void describe_match(Config& c, ConfigSchema& schema) {
  localization::LocalizerConfig& l = c.localizer;
  schema.add("match.individuals", &l.genetic.individuals, 4U, 10000U, "",
             "population of the genetic search");
  schema.add("match.generations", &l.genetic.generations, 1U, 10000U, "",
             "50 x 30 with refinement is as good as the source's 100 x 50");
  schema.add("match.crossover_rate", &l.genetic.crossover_rate, 0.0, 1.0, "",
             "probability that two parents exchange genes");
  schema.add("match.mutation_rate", &l.genetic.mutation_rate, 0.0, 0.5, "",
             "probability for each bit");
  schema.add("match.elite", &l.genetic.elite, 1U, 100U, "",
             "best individuals that live on unchanged");
  schema.add("match.branch_hypotheses", &l.genetic.branch_hypotheses, 0U, 1000U, "",
             "initial individuals, at most, that lay a branch or node on an equivalent one");
  schema.add("match.resolution_m", &l.genetic.resolution_m, 0.005, 2.0, "m",
             "of the position genes");
  schema.add("match.resolution_rad", &l.genetic.resolution_rad, 0.001, 0.5, "rad",
             "of the heading gene");
  schema.add("match.fitness", &l.fitness_form,
             {{"combined", localization::FitnessForm::kCombined},
              {"topological", localization::FitnessForm::kTopological},
              {"printed", localization::FitnessForm::kPrinted}},
             "combined: nodes, branches, scan points and the odometry prior; topological: nodes "
             "and branches; printed: the source's equations, for comparison");
  schema.add("match.solutions", &l.solutions_wanted, 1U, 40U, "",
             "best distinct solutions kept of a match");
  schema.add("match.search_probability", &l.search_probability, 0.01, 0.9999, "",
             "probability of the error ellipse whose rectangle is searched");
  schema.add("match.search_heading_sigmas", &l.search_heading_sigmas, 0.5, 6.0, "",
             "half-width of the searched headings in standard deviations");
  schema.add("gate.smallest_overlap", &l.gate.smallest_overlap, 0.0, 1.0, "",
             "share of points in the other map's view below which a match is rejected");
  schema.add("gate.smallest_inliers", &l.gate.smallest_inliers, 0.0, 1.0, "",
             "share of those that lie on a surface below which a match is rejected");
  schema.add("gate.largest_doubt", &l.gate.largest_doubt, 0.1, 10.0, "",
             "limit on what speaks against a match; smaller: fewer wrong ones, fewer loops");
  schema.add("gate.doubt_per_search_m", &l.gate.doubt_per_search_m, 0.0, 10.0, "1/m",
             "how much the limit falls with the half-width of the search");
  schema.add("gate.largest_mahalanobis2", &l.gate.largest_mahalanobis2, 1.0, 1000.0, "",
             "squared distance from the prediction in standard deviations above which a match is "
             "rejected");
  schema.add(
      "gate.largest_ambiguity", &l.gate.largest_ambiguity, 0.1, 1.0, "",
      "fitness of the second best distinct solution over the best above which a match is rejected");
}

void describe_localizer(Config& c, ConfigSchema& schema) {
  localization::LocalizerConfig& l = c.localizer;
  schema.add("localizer.mode", &l.mode,
             {{"graph", localization::LocalizerMode::kGraph},
              {"thesis", localization::LocalizerMode::kThesis}},
             "graph: a pose graph over all believed matches; thesis: the source's forward and "
             "backward correction alone, for comparison");
  schema.add("localizer.seed", &l.seed, std::uint64_t{0}, ~std::uint64_t{0}, "",
             "of everything random; the same log, seed and configuration give the same bytes");
  schema.add("localizer.recent_way_m", &l.recent_way_m, 0.5, 1000.0, "m",
             "stops up to this much way ago are recent, older ones close loops");
  schema.add("localizer.recent_matches", &l.recent_matches, 1U, 64U, "",
             "tasks per stop against recent stops");
  schema.add("localizer.revisit_matches", &l.revisit_matches, 0U, 64U, "",
             "tasks per stop against older stops; 0: loops are not closed");
  schema.add("localizer.smallest_expected_overlap", &l.smallest_expected_overlap, 0.0, 1.0, "",
             "of two maps before a task is spent on them");
  schema.add("localizer.largest_half_width_m", &l.largest_half_width_m, 0.1, 100.0, "m",
             "search spaces wider than this wait for a better prediction");
  schema.add("localizer.largest_half_width_rad", &l.largest_half_width_rad, 0.05, 3.1416, "rad",
             "the same for the heading");
  schema.add("localizer.unaided_correction_m", &l.unaided_correction_m, 0.0, 100.0, "m",
             "a loop that moves the robot further than this needs a second one that agrees");
  schema.add("localizer.unaided_correction_rad", &l.unaided_correction_rad, 0.0, 3.1416, "rad",
             "the same for the heading");
  schema.add("localizer.final_passes", &l.final_passes, 0U, 20U, "",
             "rounds of matching between places that lie near each other after the end of a log");
}

void describe_global_map(Config& c, ConfigSchema& schema) {
  topomap::GlobalMapConfig& g = c.global_map;
  schema.add("global_map.cell_m", &g.cell_m, 0.032, 0.25, "m",
             "side of a cell in which views vote for branches");
  schema.add("global_map.node_merge_m", &g.node_merge_m, 0.01, 5.0, "m",
             "nodes nearer than this and of similar clearance are one");
  schema.add("global_map.clearance_tolerance_m", &g.clearance_tolerance_m, 0.01, 5.0, "m",
             "difference of clearance up to which they are similar");
  schema.add("global_map.min_observations", &g.min_observations, 1U, 1000U, "",
             "views that must have seen an element");
  schema.add("global_map.keep_share", &g.keep_share, 0.12, 0.99, "",
             "share of the views that looked from which a place is on a branch");
  schema.add("planning.max_snap_m", &c.planning.max_snap_m, 0.0, 100.0, "m",
             "farthest that start and goal may lie from a branch");
  schema.add("planning.min_clearance_m", &c.planning.min_clearance_m, 0.0, 10.0, "m",
             "radius of the robot with a margin");
}

// Where one key stands for several variables.
void share_values(Config& c) {
  c.local_mapper.voronoi.forward_rad = -c.local_mapper.T_robot_laser.theta_rad;
  c.local_mapper.tracker.odometry = c.localizer.odometry;
}

// What no single range says: values that must fit each other.
void check_values(const Config& c) {
  topomap::check(c.global_map);
  planning::check(c.planning);
  check(c.hybrid_map);
  planning::check(c.hybrid_planner);
  navigation::check(c.navigator);
}

}  // namespace

ConfigSchema describe(Config& config) {
  ConfigSchema schema;
  describe_scan(config, schema);
  describe_local_map(config, schema);
  describe_odometry(config, schema);
  describe_match(config, schema);
  describe_localizer(config, schema);
  describe_global_map(config, schema);
  describe_hybrid_map(config.hybrid_map, schema);
  describe_hybrid_planner(config.hybrid_planner, schema);
  describe_navigator(config.navigator, schema);
  return schema;
}

LoadedConfig load_config(const std::optional<std::filesystem::path>& file) {
  LoadedConfig loaded;
  const ConfigSchema schema = describe(loaded.config);
  if (file) support::load_yaml_file(*file, schema);
  loaded.effective = support::effective(schema);
  share_values(loaded.config);
  try {
    check_values(loaded.config);
  } catch (const std::invalid_argument& error) {
    if (!file) throw;
    throw std::runtime_error(file->string() + ": " + error.what());
  }
  return loaded;
}

}  // namespace topogeo::pipeline
