#include "topogeo/pipeline/unknown_mounting.hpp"

#include <cmath>
#include <numbers>

#include "topogeo/calibration/mounting_search.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

namespace topogeo::pipeline {
namespace {

using localization::FoundMounting;

// More would make the mounting hardly more certain, but take time. A robot makes them in about 60
// m.
constexpr std::size_t kEnoughMotions = 150;
constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string found_text(const FoundMounting& found) {
  const geometry::Pose2& T = found.T_robot_laser;
  std::string text = "the laser's mounting is unknown; the scans show ";
  if (found.position_known) {
    text += fmt::format("{:.2f} m ahead, {:.2f} m to the left (+- {:.2f} m), ", T.x_m, T.y_m,
                        found.position_spread_m);
  }
  text += fmt::format("{:.1f} deg (+- {:.1f} deg){}, confidence {:.0f} % ({} of {} motions fit)",
                      T.theta_rad * kDegrees, found.heading_spread_rad * kDegrees,
                      found.upside_down ? ", upside down" : "", 100.0 * found.confidence(),
                      found.fitting, found.motions);
  if (!found.position_known) {
    text += fmt::format("; too few turns show x and y, taken as 0: --laser X,Y,{:.5g} states them",
                        T.theta_rad);
  }
  return text;
}

std::string why_open(const FoundMounting& found) {
  using localization::MountingVotes;
  if (found.motions < MountingVotes::kFewest) {
    return fmt::format("only {} motions of the robot have matching scans", found.motions);
  }
  if (2 * found.fitting < found.motions) {
    return fmt::format("only {} of {} motions fit the best one", found.fitting, found.motions);
  }
  return fmt::format("{} motions speak for the best one, {} for another", found.heading.for_it,
                     found.heading.against);
}

}  // namespace

FoundMounting find_mounting(const std::function<std::optional<scan::Scan>()>& next,
                            const Config& config) {
  localization::LaserMotions motions;
  while (motions.motions().size() < kEnoughMotions) {
    const std::optional<scan::Scan> scan = next();
    if (!scan) break;
    motions.add(topomap::scan_points(*scan, {}, config.local_mapper.local_map.points_range_m),
                scan->T_odom_robot, scan->odometry_epoch);
  }
  return localization::find_mounting(motions.motions());
}

std::string text_of(const FoundMounting& found) {
  if (found.heading_known) return found_text(found);
  return fmt::format(
      "the laser's mounting is unknown, and the scans do not show it ({}): it is taken as 0, 0, "
      "0{}; --laser X,Y,YAW states it",
      why_open(found), found.upside_down ? ", upside down" : "");
}

std::string mirroring(const FoundMounting& found) {
  constexpr double kLeastFitting = 0.8;
  if (!found.upside_down ||
      static_cast<double>(found.fitting) < kLeastFitting * static_cast<double>(found.motions)) {
    return {};
  }
  return fmt::format(
      "the scans are mirrored against the odometry ({} of {} motions fit), and cannot tell which "
      "of the two is wrong: if the laser hangs upside down, or its driver reverses the beams, "
      "expected --upside-down; if the odometry turns the wrong way, expected odometry: {{source: "
      "laser}} in a file for --config",
      found.fitting, found.motions);
}

std::string contradiction(const FoundMounting& found, const geometry::Pose2& T_robot_laser) {
  const double yaw_rad = found.T_robot_laser.theta_rad;
  const bool turned =
      found.heading_known && std::fabs(geometry::wrap_angle(yaw_rad - T_robot_laser.theta_rad)) >=
                                 FoundMounting::kOtherHeading_rad;
  if (!turned && !found.upside_down) return {};
  std::string text =
      "warning: the scans contradict the stated mounting of the laser: they show it ";
  if (turned) text += fmt::format("at {:.0f} deg", yaw_rad * kDegrees);
  if (turned && found.upside_down) text += " and ";
  if (found.upside_down) text += "upside down, or mirrored";
  text += fmt::format(" ({} of {} motions fit); if they are right:", found.fitting, found.motions);
  if (turned) text += " --laser " + mounting_argument(found.T_robot_laser);
  if (found.upside_down) text += " --upside-down";
  return text;
}

}  // namespace topogeo::pipeline
