#include "topogeo/topomap/local_map_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::topomap {
namespace {

void describe_confirmation(LocalMapConfig& m, support::ConfigSchema& schema) {
  schema.add("local_map.points_range_m", &m.points_range_m, 0.5, 80.0, "m",
             "readings beyond it are not matched; larger than range_limit_m, because only the far "
             "end of a corridor shows the robot's position along it");
  schema.add("local_map.largest_hidden_share", &m.largest_hidden_share, 0.0, 1.0, "",
             "part of the clearance by which the circle of a real node or confirmed branch may "
             "reach into unseen space; 1: all are real, as in the thesis");
  schema.add("local_map.min_stretch_m", &m.min_stretch_m, 0.0, 10.0, "m",
             "shorter stretches of a branch, confirmed or not, count as the stretches beside them; "
             "the same as min_branch_m");
  schema.add("local_map.min_main_graph_m", &m.min_main_graph_m, 0.0, 100.0, "m",
             "Thesis, 5.2.2: a graph with a shorter total branch length is not the main graph if "
             "there is another one, because a stub beside the robot leads nowhere");
  schema.add("local_map.remove_off_main_graph", &m.remove_off_main_graph,
             "Thesis, 5.2.2: removes everything off the graph nearest to the robot instead of "
             "marking it; then 0.90 of the branch points are found again instead of 0.92");
  schema.fix({"local_map.min_stretch_m"});
}

void describe_states(LocalMapConfig& m, support::ConfigSchema& schema) {
  schema.add("local_map.find_states", &m.find_states,
             "Thesis, 5.2.2.1: finds doors, narrowings and hall-corridor passages along branches");
  schema.add("local_map.state_rule", &m.state_rule,
             {{"floors", StateRule::kFloors}, {"slopes", StateRule::kSlopes}},
             "floors: minima and plateaus of the clearance; slopes: each change of its slope that "
             "later points confirm, as printed in the thesis (eq. 5.1-5.4), for comparison");
  schema.add("local_map.state_rise_m", &m.state_rise_m, 0.01, 10.0, "m",
             "eq. 5.3: rise of the clearance on a side of a minimum that counts as a change of "
             "slope; twice the error of a reading, because a branch point depends on two readings");
  schema.add("local_map.state_confirm_m", &m.state_confirm_m, 0.0, 10.0, "m",
             "eq. 5.4: the point that confirms a change of slope lies farther than this from it");
  schema.add("local_map.state_reach_m", &m.state_reach_m, 0.0, 10.0, "m",
             "distance to both sides within which the position of a door or narrowing is fitted: "
             "seven points of 5 cm cells, without a second minimum");
  schema.add(
      "local_map.plateau_m", &m.plateau_m, 0.0, 10.0, "m",
      "clearances that differ by at most this are one plateau; twice the error of a reading");
  schema.add("local_map.corridor_length_m", &m.corridor_length_m, 0.1, 100.0, "m",
             "a plateau at least this long is a corridor with a passage at each open end, a "
             "shorter one a door or narrowing; no door leaf or pillar is as deep");
  schema.add("local_map.hall_rise_m", &m.hall_rise_m, 0.01, 10.0, "m",
             "rise of the clearance from a corridor to a hall; more than at the niche of a door");
  schema.add("local_map.door_half_width_m", &m.door_half_width_m, 0.1, 5.0, "m",
             "minima of the clearance up to this are doors, larger ones narrowings; half of the "
             "width of a wide single door");
  schema.add("local_map.door_min_half_width_m", &m.door_min_half_width_m, 0.0, 5.0, "m",
             "smaller minima of the clearance are narrowings, because the robot does not fit "
             "through; just over half of its width");
  schema.add(
      "local_map.separated_m", &m.separated_m, 0.05, 10.0, "m",
      "eq. 5.5: loose ends of the same groups nearer than this belong to one branch that was not "
      "seen whole; a missing beam leaves a smaller gap, another room's branch a larger one");
  schema.fix({"local_map.state_confirm_m", "local_map.state_reach_m", "local_map.hall_rise_m"});
}

}  // namespace

void describe(LocalMapConfig& config, support::ConfigSchema& schema) {
  describe_confirmation(config, schema);
  describe_states(config, schema);
}

void check(const LocalMapConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::topomap
