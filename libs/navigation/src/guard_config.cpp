#include "topogeo/navigation/guard_config.hpp"

#include <numbers>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::navigation {
namespace {

support::NumberRows rows_of(const geometry::Footprint& footprint) {
  support::NumberRows rows;
  for (const Eigen::Vector2d& corner_m : footprint.corners_m) {
    rows.push_back({corner_m.x(), corner_m.y()});
  }
  return rows;
}

std::optional<geometry::Footprint> footprint_of(const support::NumberRows& rows) {
  geometry::Footprint footprint;
  for (const std::vector<double>& row : rows) {
    if (row.size() != 2) return std::nullopt;
    footprint.corners_m.emplace_back(row[0], row[1]);
  }
  return footprint;
}

}  // namespace

bool plans_poses(const GuardConfig& config) {
  return !config.footprint.empty() || config.minimum_turning_radius_m > 0.0;
}

geometry::Footprint outline_of(const GuardConfig& config) {
  if (!config.footprint.empty()) return config.footprint;
  constexpr int kCorners = 16;
  constexpr double kCorner_rad = 2.0 * std::numbers::pi / kCorners;
  const double corner_m = config.radius_m / geometry::sincos(0.5 * kCorner_rad).cos;
  geometry::Footprint disc;
  for (int k = 0; k < kCorners; ++k) {
    const geometry::SinCos at = geometry::sincos(k * kCorner_rad);
    disc.corners_m.emplace_back(corner_m * at.cos, corner_m * at.sin);
  }
  return disc;
}

void describe(GuardConfig& config, support::ConfigSchema& schema) {
  schema.add_rows("robot.footprint", &config.footprint, rows_of, footprint_of,
                  "corners [[x, y], ...] in m, 3 to 32 within 3 m of the origin, of a simple "
                  "polygon around it",
                  "outline of a body that is not round, in the robot's frame (x ahead, y to the "
                  "left, the origin between the driven wheels); empty: round, guard.radius_m");
  schema.leave_out_of_fingerprint("robot");
  schema.add(
      "base.minimum_turning_radius_m", &config.minimum_turning_radius_m, 0.0, 10.0, "m",
      "smallest radius of a turn of the robot's origin; 0: the base turns on the spot, above: "
      "a tricycle or car, whose origin is in the middle of the axle that does not steer");
  schema.leave_out_of_fingerprint("base");
  schema.add("guard.radius_m", &config.radius_m, 0.05, 2.0, "m",
             "radius of the robot's round body; unused with robot.footprint");
  schema.add("guard.margin_m", &config.margin_m, 0.0, 1.0, "m",
             "smallest distance between the body and obstacles while the robot drives");
  schema.add("guard.side_margin_m", &config.side_margin_m, 0.0, 1.0, "m",
             "smallest distance from obstacles beside the robot; doors leave no more");
  schema.add("guard.deceleration_m_per_s2", &config.deceleration_m_per_s2, 0.05, 10.0, "m/s2",
             "deceleration that the base reaches in any case; the robot drives only as fast as it "
             "can stop before an obstacle");
  schema.add("guard.delay_s", &config.delay_s, 0.0, 2.0, "s",
             "time from the guard's decision until the base obeys; the age of the guard's inputs "
             "is added");
  schema.add("guard.runs_on_s", &config.runs_on_s, 0.0, 10.0, "s",
             "time for which the base runs on when the gateway or its host freezes: at least "
             "base.watchdog_s of the devices");
  schema.add("guard.oldest_scan_s", &config.oldest_scan_s, 0.05, 10.0, "s",
             "largest age of a scan; a laser delivers two to ten a second");
  schema.add("guard.needs_scan", &config.needs_scan,
             "no motion without a laser scan; false: sonars are enough");
  schema.add("guard.needs_sonar", &config.needs_sonar, "no motion without sonar readings");
  schema.add("guard.sonar_reach_m", &config.sonar_reach_m, 0.2, 5.0, "m",
             "sonars must detect anything that the laser sees in their cone nearer than this");
  schema.add("guard.sonar_least_m", &config.sonar_least_m, 0.0, 1.0, "m",
             "a sonar ahead or behind that reads this or less may have an obstacle at the body, "
             "because sonars measure no shorter distance");
  schema.add("guard.silent_s", &config.silent_s, 0.1, 60.0, "s",
             "sonars count as silent after this time without an expected echo");
  schema.add("guard.laser_fields", &config.laser_fields,
             "obeys the fields that are set up in the laser: no motion ahead with an obstacle in "
             "the protective field");
  schema.add("guard.warning_field_m_per_s", &config.warning_field_m_per_s, 0.0, 10.0, "m/s",
             "largest speed ahead with an obstacle in the warning field of the laser");
  schema.fix({"guard.sonar_least_m", "guard.silent_s", "guard.sonar_reach_m"});
}

void check(const GuardConfig& config) {
  support::check_ranges(config);
  const std::string fault = geometry::fault_of(config.footprint);
  if (!fault.empty()) throw std::invalid_argument("key 'robot.footprint' " + fault);
}

}  // namespace topogeo::navigation
