#include "topogeo/navigation/guard_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {

void describe(GuardConfig& config, support::ConfigSchema& schema) {
  schema.add("guard.radius_m", &config.radius_m, 0.05, 2.0, "m", "of the robot's round body");
  schema.add("guard.margin_m", &config.margin_m, 0.0, 1.0, "m",
             "nothing comes nearer to the body while it drives");
  schema.add("guard.side_margin_m", &config.side_margin_m, 0.0, 1.0, "m",
             "it passes what is beside it at this distance: in doors there is no more");
  schema.add("guard.deceleration_m_per_s2", &config.deceleration_m_per_s2, 0.05, 10.0, "m/s2",
             "that the base surely can: its speed is such that it can stop before what it sees");
  schema.add("guard.delay_s", &config.delay_s, 0.0, 2.0, "s",
             "from its judgement until the base obeys; the age of what it judges by comes on top");
  schema.add("guard.runs_on_s", &config.runs_on_s, 0.0, 10.0, "s",
             "that the base runs on when the gateway or its host freezes: at least base.watchdog_s "
             "of the devices");
  schema.add("guard.oldest_scan_s", &config.oldest_scan_s, 0.05, 10.0, "s",
             "an older scan is none; a laser gives two to ten a second");
  schema.add("guard.needs_scan", &config.needs_scan,
             "no motion without a laser scan; off: sonars are enough");
  schema.add("guard.needs_sonar", &config.needs_sonar, "no motion without sonars");
  schema.add("guard.sonar_reach_m", &config.sonar_reach_m, 0.2, 5.0, "m",
             "sonars must hear what the laser sees in their cone nearer than this");
  schema.add("guard.sonar_least_m", &config.sonar_least_m, 0.0, 1.0, "m",
             "a sonar ahead or behind that reads this or less may have something at the body: "
             "sonars measure no less");
  schema.add("guard.silent_s", &config.silent_s, 0.1, 60.0, "s",
             "so long without an echo where there must be one, and the sonars count as silent");
  schema.add("guard.laser_fields", &config.laser_fields,
             "obeys the fields that are set up in the laser: no motion ahead with something in the "
             "protective field");
  schema.add("guard.warning_field_m_per_s", &config.warning_field_m_per_s, 0.0, 10.0, "m/s",
             "largest speed ahead with something in the warning field of the laser");
}

void check(const GuardConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::navigation
