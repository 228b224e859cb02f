// topogeo calibrate-laser: finds the mounting of the laser on a robot from one of its logs.
#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/calibration/laser_calibration.hpp"
#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "calibrate/calibration_log.hpp"
#include "commands.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

using geometry::Pose2;
using localization::LaserCalibration;
using localization::MountingEstimate;

constexpr double kMountingDegrees = 180.0 / std::numbers::pi;

struct CalibrateLaserOptions {
  std::filesystem::path log;
  recording::TopicChoice topics;
  std::optional<std::filesystem::path> config;
  std::optional<std::filesystem::path> out;
};

/// With a wrong mounting the laser moves differently from the odometry. These variances, about a
/// decimetre for each radian of turn and each metre of path, allow matches in spite of that.
constexpr double kTurnShiftVariance = 0.02;  // m2/rad
constexpr double kSidewaysVariance = 0.01;   // m2/m

pipeline::Config searching_widely(pipeline::Config config, const Pose2& T_robot_laser) {
  pipeline::mount_laser(config, T_robot_laser);
  for (auto* noise : {&config.localizer.odometry, &config.local_mapper.tracker.odometry,
                      &config.calibration.fallback}) {
    noise->translation_m2_per_rad = std::max(noise->translation_m2_per_rad, kTurnShiftVariance);
    noise->lateral_m2_per_m = std::max(noise->lateral_m2_per_m, kSidewaysVariance);
  }
  return config;
}

/// The result, and the matched log behind it.
struct Found {
  MatchedLog log;
  LaserCalibration laser;
};

Found calibrate_once(const CalibrateLaserOptions& options, const pipeline::Config& config,
                     bool first) {
  OpenLog log = open_log(options.log, config.log, options.topics);
  Found found;
  found.log = match_log(config, log);
  if (first) report_skipped(log.reader.statistics());
  try {
    Bar bar("refitting", "fits");
    found.laser = localization::calibrate_laser(
        localization::odometry_stretches(found.log.maps), found.log.matched.motions,
        config.local_mapper.T_robot_laser, config.calibration,
        [&](std::size_t done, std::size_t total) { bar.update(done, total); });
    bar.finish();
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(options.log.string() + ": " + error.what());
  }
  return found;
}

/// Matches the scans again with the mounting found, until it changes little. A wrong mounting
/// misses the best matches, which are those of long paths and large turns.
Found calibrate_laser(const CalibrateLaserOptions& options, const pipeline::Config& config) {
  constexpr int kMostRounds = 6;
  constexpr double kSmallShift_m = 0.003;
  constexpr double kSmallShift_rad = 0.002;
  Pose2 T_robot_laser = config.local_mapper.T_robot_laser;
  for (int round = 1;; ++round) {
    Found found = calibrate_once(options, searching_widely(config, T_robot_laser), round == 1);
    const Eigen::Vector3d shift = geometry::difference(found.laser.T_robot_laser(), T_robot_laser);
    T_robot_laser = found.laser.T_robot_laser();
    const bool settled =
        shift.head<2>().norm() < std::max(kSmallShift_m, found.laser.x_m.spread) &&
        std::fabs(shift.z()) < std::max(kSmallShift_rad, found.laser.yaw_rad.spread);
    if (settled || round == kMostRounds) return found;
  }
}

std::string why_unknown(std::size_t stretches, const char* what, double spread, const char* unit) {
  if (stretches < localization::kFewestStretches) {
    return fmt::format("only {} stretches have {}, {} are needed", stretches, what,
                       localization::kFewestStretches);
  }
  return fmt::format("it leaves +- {:.2g} {}", spread, unit);
}

void print_part(const char* name, const MountingEstimate& part, double factor, const char* unit,
                std::size_t stretches, const char* what) {
  if (part.known) {
    std::cout << fmt::format("  {:<5}{:>+8.3f} +- {:<6.3f} {}\n", name, factor * part.value,
                             factor * part.spread, unit);
    return;
  }
  std::cout << fmt::format("  {:<5} not observable in this log: {}; {:+.3f} {} is kept\n", name,
                           why_unknown(stretches, what, factor * part.spread, unit),
                           factor * part.value, unit);
}

std::string laser_yaml(const LaserCalibration& laser) {
  return fmt::format("laser:\n  x_m: {:.4f}\n  y_m: {:.4f}\n  yaw_rad: {:.5f}\n", laser.x_m.value,
                     laser.y_m.value, laser.yaw_rad.value);
}

/// Chooses the start of the search: the mounting that the scans show if the configured one is too
/// far from it.
void start_near(const localization::FoundMounting& shown, pipeline::LoadedConfig& config,
                recording::TopicChoice& topics) {
  constexpr double kWithinReach_rad = 15.0 / kMountingDegrees;
  topics.upside_down |= shown.upside_down;
  const Pose2& T_configured = config.config.local_mapper.T_robot_laser;
  const double apart_rad =
      geometry::wrap_angle(shown.T_robot_laser.theta_rad - T_configured.theta_rad);
  if (!shown.heading_known || std::fabs(apart_rad) <= kWithinReach_rad) return;
  pipeline::mount_laser(config.config, shown.T_robot_laser);
}

/// Adds the search's values for the parts that the refinement leaves open, because the search needs
/// less driving.
LaserCalibration completed(LaserCalibration laser, const localization::FoundMounting& shown) {
  const Pose2& T = shown.T_robot_laser;
  if (shown.heading_known && !laser.yaw_rad.known) {
    laser.yaw_rad = {true, T.theta_rad, shown.heading_spread_rad};
  }
  if (shown.position_known && !(laser.x_m.known && laser.y_m.known)) {
    laser.x_m = {true, T.x_m, shown.position_spread_m};
    laser.y_m = {true, T.y_m, shown.position_spread_m};
  }
  return laser;
}

/// Refines the mounting, or prints the reason why only the result of the search is available.
LaserCalibration calibrate_from(const localization::FoundMounting& shown,
                                const CalibrateLaserOptions& options,
                                const pipeline::Config& config) {
  const std::string name = options.log.filename().string();
  try {
    const Found found = calibrate_laser(options, config);
    std::cout << fmt::format("{}: {}\n", name, describe_drive(found.log.maps))
              << describe_matches(config, found.log.matched)
              << fmt::format("; {} outlying\n\n", found.laser.outlying);
    return completed(found.laser, shown);
  } catch (const service::BadInputError& error) {
    if (!shown.heading_known) throw;
    std::cout << fmt::format("{}; a search with {} motions shows:\n\n", error.what(),
                             shown.motions);
    LaserCalibration nothing;
    nothing.with_path = nothing.with_turn = localization::kFewestStretches;  // the spread says why
    const Pose2& T_configured = config.local_mapper.T_robot_laser;
    nothing.x_m = {false, T_configured.x_m, shown.position_spread_m};
    nothing.y_m = {false, T_configured.y_m, shown.position_spread_m};
    return completed(nothing, shown);
  }
}

int calibrate_laser_log(CalibrateLaserOptions options) {
  pipeline::LoadedConfig config =
      load_for_calibration(options.config, options.out, options.log, options.topics);
  const localization::FoundMounting shown =
      search_mounting(config.config, options.log, options.topics);
  start_near(shown, config, options.topics);
  const LaserCalibration laser = calibrate_from(shown, options, config.config);
  const std::string name = options.log.filename().string();
  std::cout << "the laser, seen from the point of the robot that its odometry refers to:\n";
  if (options.topics.upside_down) std::cout << "  it is upside down: --upside-down\n";
  constexpr const char* kTurn = "0.2 rad of turn";
  print_part("x", laser.x_m, 1.0, "m forward", laser.with_turn, kTurn);
  print_part("y", laser.y_m, 1.0, "m to the left", laser.with_turn, kTurn);
  print_part("yaw", laser.yaw_rad, kMountingDegrees, "degrees counter-clockwise", laser.with_path,
             "0.2 m of path");
  const std::string block = laser_yaml(laser);
  std::cout << '\n' << block;
  if (options.out) {
    const std::string comment = "Laser of " + name + ", by topogeo calibrate-laser.";
    support::write_file_atomically(
        *options.out, configuration_with(block, comment, options.config, laser.T_robot_laser()));
    std::cout << "written to " << options.out->string() << '\n';
  }
  if (laser.x_m.known || laser.y_m.known || laser.yaw_rad.known) return service::kOk;
  std::cerr << "topogeo: " << options.log.string() << ": nothing of the mounting is observable\n";
  return service::kBadInput;
}

}  // namespace

void add_calibrate_laser_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "calibrate-laser", "Estimate the mounting of the laser on its robot from a log");
  auto options = std::make_shared<CalibrateLaserOptions>();
  add_topic_options(*command, options->topics);
  command->add_option("LOG", options->log, recording::kLogFormats)->required()->type_name("FILE");
  command
      ->add_option("--config", options->config,
                   "configuration (YAML); the search starts at its laser section, without it at "
                   "that of the log")
      ->type_name("FILE");
  command
      ->add_option(
          "--out", options->out,
          "configuration to write: the values found and, with --config, all of its other values")
      ->type_name("FILE");
  command->footer(
      "Turns show x and y, straight paths show yaw: drive some minutes with both, turning to both\n"
      "sides, through rooms. A part that the log does not show is left as it is configured.\n"
      "Poses are then those of the point that odometry refers to, no longer of the laser.\n"
      "Example:\n"
      "  topogeo calibrate-laser drive.clf.gz --out robot.yaml\n"
      "  topogeo map --log drive.clf.gz --config robot.yaml --out map");
  command->callback([options, &exit_code] { exit_code = calibrate_laser_log(*options); });
}

}  // namespace topogeo::cli
