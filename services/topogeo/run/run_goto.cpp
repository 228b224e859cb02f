// topogeo run --goto: sends a simulated robot to a place on a stored map.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "run/goto_drive.hpp"
#include "run/run_log.hpp"

namespace topogeo::cli {
namespace {

using topomap::StampedPose;

/// Prints the errors of the estimated poses against the truth.
void print_pose_errors(const std::vector<StampedPose>& estimated,
                       const std::vector<StampedPose>& truth) {
  const std::vector<StampedPose> true_poses = truth_at(estimated, truth);
  double sum_m2 = 0.0;
  double largest_m = 0.0;
  std::size_t i = 0;
  for (const StampedPose& pose : true_poses) {
    while (estimated[i].stamp_ns < pose.stamp_ns) ++i;
    const double error_m = (estimated[i].pose.position_m() - pose.pose.position_m()).norm();
    sum_m2 += error_m * error_m;
    largest_m = std::max(largest_m, error_m);
  }
  if (true_poses.empty()) return;
  std::cout << fmt::format(
      "its pose while driving was off by {:.3f} m rms, {:.3f} m at most ({} poses)\n",
      std::sqrt(sum_m2 / static_cast<double>(true_poses.size())), largest_m, true_poses.size());
}

void print_arrival(const RunOptions& options, const GotoResult& result) {
  const auto& status = *result.status;
  std::cout << fmt::format("arrived at {} after {:.1f} m and {:.0f} s; {} collisions, {} detours\n",
                           options.goal->target, status.driven_m, result.drive_s, result.collisions,
                           status.detours);
  if (!result.goal_m || result.truth.empty()) return;
  const geometry::Pose2& truth = result.truth.back().pose;
  std::string text = fmt::format("by ground truth it is {:.3f} m from the goal",
                                 (truth.position_m() - *result.goal_m).norm());
  if (options.goal->heading_deg) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const double off_rad =
        geometry::wrap_angle(truth.theta_rad - *options.goal->heading_deg / kDegrees);
    text += fmt::format(" with {:.1f} degrees of heading error", std::fabs(off_rad) * kDegrees);
  }
  if (status.T_map_robot) {
    text += fmt::format("; by its own pose {:.3f} m",
                        (status.T_map_robot->position_m() - *result.goal_m).norm());
  }
  std::cout << text << '\n';
  print_pose_errors(result.estimated, result.truth);
}

/// Without a laser no scan is matched, so any map with a grid will do.
JobOptions inputs_of(JobOptions job, bool no_laser) {
  if (!no_laser) return job;
  job.map.reset();
  job.initial_pose.reset();
  return job;
}

/// The base station on which a robot without a laser stands.
std::string station_of(const navigation::NavigatorConfig& config) {
  if (config.pose_source == navigation::PoseSource::kMarkov && !config.markov_by_laser &&
      !config.guard.needs_scan) {
    return config.markov.station;
  }
  throw service::UsageError(
      "--no-laser: expected navigator: {pose_source: markov} by sonars and guard: "
      "{needs_scan: false} in --config, see deploy/sonar_robot.example.yaml");
}

}  // namespace

int run_goto(RunOptions options) {
  static_cast<void>(to_goal(*options.goal));
  check_picture(options.goal->picture);
  const bool no_laser = options.simulation && options.simulation->no_laser;
  JobOptions job = inputs_of(options.job, no_laser);
  const pipeline::Config config = check_inputs(job).config.config;
  options.laser = config.local_mapper.T_robot_laser;
  if (no_laser) options.station = station_of(config.navigator);
  if (!options.goal->picture) options.goal->picture = options.job.out / "route.png";
  prepare_simulation(options);
  const GotoResult result = GotoDrive(options).run();
  if (!result.estimated.empty()) {
    storage::write_trajectory_tum(options.job.out / "trajectory.tum", result.estimated);
    storage::write_trajectory_tum(options.job.out / "truth.tum",
                                  truth_at(result.estimated, result.truth));
  }
  if (result.signal_number != 0) {
    std::cerr << "topogeo: stopped\n";
    return kSignalBase + result.signal_number;
  }
  if (!result.arrived) throw std::runtime_error(result.failure);
  print_arrival(options, result);
  std::cout << "the route: " << options.goal->picture->string() << '\n';
  return service::kOk;
}

void add_goal_run_options(command_line::Command& app, GoalOptions& options, bool& unknown_start,
                          command_line::Option* needed) {
  command_line::Option* target =
      app.add_option("--goto", options.target,
                     "send the simulated robot to this goal in the given map")
          ->type_name("PLACE|X,Y|#NODE");
  if (needed != nullptr) target->needs(needed);
  add_goal_options(app, options);
  app.add_flag("--unknown-start", unknown_start,
               "give the robot no initial pose: it searches the whole map");
  for (const char* name :
       {"--heading", "--look-around", "--picture", "--patience", "--unknown-start"}) {
    app.get_option(name)->needs(target);
  }
}

}  // namespace topogeo::cli
