#include "topogeo/navigation/explorer_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {
namespace {

void describe_targets(ExplorerConfig& e, support::ConfigSchema& schema) {
  schema.add("explorer.unknown_near_m", &e.unknown_near_m, 0.1, 5.0, "m",
             "a target is open if unknown floor is within this distance");
  schema.add(
      "explorer.sight_m", &e.sight_m, 0.1, 20.0, "m",
      "unknown floor further than this behind a target does not count; at least unknown_near_m");
  schema.add("explorer.least_area_m2", &e.least_area_m2, 0.0, 100.0, "m2",
             "least unknown floor at a target; the robot skips a target with less");
  schema.add("explorer.worth_m_per_m2", &e.worth_m_per_m2, 1.0, 10000.0, "m/m2",
             "longest drive to a target per square metre of its unknown floor");
  schema.add("explorer.passage_side_m", &e.passage_side_m, 0.3, 5.0, "m",
             "distance from the middle of a passage at which its sides are checked");
  schema.add("explorer.gap_side_m", &e.gap_side_m, 0.3, 10.0, "m",
             "side of the squares in which borders of the known floor are counted");
  schema.add("explorer.least_gap_m", &e.least_gap_m, 0.1, 10.0, "m",
             "shorter borders in a square are no targets");
  schema.add("explorer.least_room_m2", &e.least_room_m2, 0.0, 100.0, "m2",
             "smaller rooms need not be entered");
  schema.fix({"explorer.unknown_near_m", "explorer.passage_side_m", "explorer.gap_side_m",
              "explorer.least_gap_m"});
}

void describe_views(ExplorerConfig& e, support::ConfigSchema& schema) {
  schema.add("explorer.approach_m", &e.approach_m, 0.1, 10.0, "m",
             "the robot views a target from within this distance if there is room");
  schema.add("explorer.view_m", &e.view_m, 0.1, 10.0, "m",
             "largest distance of a view otherwise; at least approach_m");
  schema.add("explorer.sure_m", &e.sure_m, 0.0, 2.0, "m",
             "no unknown cell lies within this distance of a position to which the robot is sent");
  schema.add(
      "explorer.together_m", &e.together_m, 0.0, 10.0, "m",
      "targets viewed from positions nearer than this count as one on the tour that orders them");
  schema.add("explorer.tour", &e.tour, 1U, 30U, "targets", "nearest targets that are put in order");
  schema.fix({"explorer.view_m", "explorer.sure_m", "explorer.together_m", "explorer.tour"});
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
             "the robot gives up a target after this time without getting nearer to it");
  schema.add("explorer.settle_s", &config.settle_s, 0.0, 600.0, "s",
             "wait for map updates, without a target, before the floor counts as explored");
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
