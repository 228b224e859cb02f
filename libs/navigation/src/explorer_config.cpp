#include "topogeo/navigation/explorer_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {
namespace {

void describe_targets(ExplorerConfig& e, support::ConfigSchema& schema) {
  schema.add("explorer.unknown_near_m", &e.unknown_near_m, 0.1, 5.0, "m",
             "a target is open when unknown floor is this near");
  schema.add("explorer.sight_m", &e.sight_m, 0.1, 20.0, "m",
             "what lies further behind a target is not counted; at least unknown_near_m");
  schema.add("explorer.least_area_m2", &e.least_area_m2, 0.0, 100.0, "m2",
             "the robot goes to no target with less unknown floor");
  schema.add("explorer.worth_m_per_m2", &e.worth_m_per_m2, 1.0, 10000.0, "m/m2",
             "nor from so many metres away for each square metre of unknown floor");
  schema.add("explorer.passage_side_m", &e.passage_side_m, 0.3, 5.0, "m",
             "distance from the middle of a passage at which its sides are checked");
  schema.add("explorer.gap_side_m", &e.gap_side_m, 0.3, 10.0, "m",
             "borders of the known floor are counted in squares of this side");
  schema.add("explorer.least_gap_m", &e.least_gap_m, 0.1, 10.0, "m",
             "shorter borders in a square are no targets");
  schema.add("explorer.least_room_m2", &e.least_room_m2, 0.0, 100.0, "m2",
             "smaller rooms need not be entered");
}

void describe_views(ExplorerConfig& e, support::ConfigSchema& schema) {
  schema.add("explorer.approach_m", &e.approach_m, 0.1, 10.0, "m",
             "a target is looked at from this near, if there is room");
  schema.add("explorer.view_m", &e.view_m, 0.1, 10.0, "m",
             "or else from so far at most; at least approach_m");
  schema.add("explorer.sure_m", &e.sure_m, 0.0, 2.0, "m",
             "nothing unknown is so near to where the robot is sent");
  schema.add("explorer.together_m", &e.together_m, 0.0, 10.0, "m",
             "targets seen from places nearer than this are one on the tour that decides on their "
             "order");
  schema.add("explorer.tour", &e.tour, 1U, 30U, "targets",
             "so many of the nearest ones are put in order");
}

// Checks relations between settings.
void check_order(const ExplorerConfig& e) {
  support::require_at_least("explorer.sight_m", e.sight_m, "explorer.unknown_near_m",
                            e.unknown_near_m);
  support::require_at_least("explorer.view_m", e.view_m, "explorer.approach_m", e.approach_m);
}

}  // namespace

void describe(ExplorerConfig& config, support::ConfigSchema& schema) {
  describe_targets(config, schema);
  describe_views(config, schema);
}

void describe(TourConfig& config, support::ConfigSchema& schema) {
  describe(config.explorer, schema);
  schema.add("explorer.patience_s", &config.patience_s, 1.0, 3600.0, "s",
             "a target that the robot cannot get nearer to for so long is given up");
  schema.add("explorer.settle_s", &config.settle_s, 0.0, 600.0, "s",
             "wait for the map, without a target, before the floor counts as explored");
}

void check(const ExplorerConfig& config) {
  support::check_ranges(config);
  check_order(config);
}

void check(const TourConfig& config) {
  support::check_ranges(config);
  check_order(config.explorer);
}

}  // namespace topogeo::navigation
