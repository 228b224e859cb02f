#include "topogeo/pipeline/unknown_mounting.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "topogeo/calibration/mounting_change.hpp"
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
// Later samples show whether the mounting stays.
constexpr std::size_t kMotionsOfSample = 16;
constexpr double kBetweenSamples_m = 50.0;
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

/// For --laser, to tenths of millimetres.
std::string argument_of(const FoundMounting& found) {
  const geometry::Pose2& T = found.T_robot_laser;
  return fmt::format("{:.4g},{:.4g},{:.5g}", T.x_m, T.y_m, T.theta_rad);
}

int degrees_of(const geometry::Pose2& T) {
  return static_cast<int>(std::lround(T.theta_rad * kDegrees));
}

/// So sure that a statement to the contrary is not followed without another one.
bool surely_fits(const FoundMounting& found) {
  constexpr double kLeastFitting = 0.8;
  return static_cast<double>(found.fitting) >= kLeastFitting * static_cast<double>(found.motions);
}

bool is_turned(const FoundMounting& found, const geometry::Pose2& T_robot_laser) {
  const double apart_rad = found.T_robot_laser.theta_rad - T_robot_laser.theta_rad;
  return found.heading_known &&
         std::fabs(geometry::wrap_angle(apart_rad)) >= FoundMounting::kOtherHeading_rad;
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

DriveMotions laser_motions(const NextScan& next, const Config& config) {
  DriveMotions drive;
  localization::LaserMotions sample;
  std::size_t wanted = kEnoughMotions;
  double path_m = 0.0;  // since the last sample
  std::optional<scan::Scan> last;
  while (std::optional<scan::Scan> scan = next()) {
    if (!last) drive.first_ns = scan->stamp_ns;
    if (wanted > 0) {
      sample.add(topomap::scan_points(*scan, {}, config.local_mapper.local_map.points_range_m),
                 scan->stamp_ns, scan->T_odom_robot, scan->odometry_epoch);
      if (sample.motions().size() == wanted) {
        drive.motions.insert(drive.motions.end(), sample.motions().begin(), sample.motions().end());
        sample = {};
        wanted = 0;
        path_m = 0.0;
      }
    } else if (last && last->odometry_epoch == scan->odometry_epoch) {
      path_m += geometry::between(last->T_odom_robot, scan->T_odom_robot).position_m().norm();
      if (path_m >= kBetweenSamples_m) wanted = kMotionsOfSample;
    }
    last = std::move(scan);
  }
  drive.motions.insert(drive.motions.end(), sample.motions().begin(), sample.motions().end());
  return drive;
}

FoundMounting find_mounting(const DriveMotions& drive) {
  const std::span<const localization::LaserMotion> motions = drive.motions;
  return localization::find_mounting(motions.first(std::min(motions.size(), kEnoughMotions)));
}

std::string text_of(const FoundMounting& found) {
  if (found.heading_known) return found_text(found);
  return fmt::format(
      "the laser's mounting is unknown, and the scans do not show it ({}): it is taken as 0, 0, "
      "0{}; --laser X,Y,YAW states it",
      why_open(found), found.upside_down ? ", upside down" : "");
}

std::string mirroring(const FoundMounting& found) {
  if (!found.upside_down || !surely_fits(found)) return {};
  return fmt::format(
      "the scans are mirrored against the odometry ({} of {} motions fit), and cannot tell which "
      "of the two is wrong: if the laser hangs upside down, or its driver reverses the beams, "
      "expected --upside-down; if the odometry turns the wrong way, expected odometry: {{source: "
      "laser}} in a file for --config",
      found.fitting, found.motions);
}

std::string other_heading(const FoundMounting& found, const geometry::Pose2& T_robot_laser) {
  if (found.upside_down || !is_turned(found, T_robot_laser) || !surely_fits(found)) return {};
  // If the odometry has another heading than the robot, the stated mounting is turned about the
  // robot's centre, whose path and map are the same by either.
  constexpr double kSame_m = 0.1;
  const geometry::Pose2 turned =
      geometry::Pose2{0.0, 0.0, found.T_robot_laser.theta_rad - T_robot_laser.theta_rad} *
      T_robot_laser;
  const double apart_m = (turned.position_m() - found.T_robot_laser.position_m()).norm();
  if (!found.position_known || apart_m <= kSame_m) return {};
  return fmt::format(
      "the laser is stated at {} deg, but the scans show it at {} deg ({} of {} motions "
      "fit): if they are right, expected --laser {}; if the stated mounting is, expected --laser "
      "{}",
      degrees_of(T_robot_laser), degrees_of(found.T_robot_laser), found.fitting, found.motions,
      argument_of(found), mounting_argument(T_robot_laser));
}

std::string changing(const DriveMotions& drive, const FoundMounting& found) {
  const auto change = localization::find_mounting_change(drive.motions, found);
  if (!change) return {};
  const auto heading = [](const FoundMounting& mounting) {
    return fmt::format("{} deg{}", degrees_of(mounting.T_robot_laser),
                       mounting.upside_down ? " upside down" : "");
  };
  return fmt::format(
      "the laser does not stay where it is on the robot: until about {:.0f} s the scans show it at "
      "{}, then at {}; cut the log there, map the first part, and add the second with --continue "
      "and --laser {} (or --laser X,Y,YAW, which is not checked, for the whole log)",
      1e-9 * static_cast<double>(change->stamp_ns - drive.first_ns), heading(change->before),
      heading(change->after), argument_of(change->after));
}

std::string text_of(const localization::ScanDelay& delay) {
  return fmt::format(
      "the stamps of the scans are {:.2f} s {} than those of the odometry ({} turns fit that, {} "
      "equal clocks): it is taken out; --scan-delay 0 keeps them",
      std::fabs(delay.delay_s), delay.delay_s > 0.0 ? "later" : "earlier", delay.votes.for_it,
      delay.votes.against);
}

std::string contradiction(const FoundMounting& found, const geometry::Pose2& T_robot_laser) {
  const double yaw_rad = found.T_robot_laser.theta_rad;
  const bool turned = is_turned(found, T_robot_laser);
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
