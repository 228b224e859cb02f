// The work of `topogeo run`, for the commands that need it.
#pragma once

#include <iosfwd>
#include <span>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/storage/report.hpp"
#include "topogeo/support/config_schema.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "run/run_services.hpp"
#include "run/run_supervisor.hpp"

namespace topogeo::cli {

/// Maps the log with all services, writes report.json and prints the summary. Returns the exit code
/// (service::kOk or 128 + signal). Throws service::UsageError, service::BadInputError when
/// something cannot be started and std::runtime_error for a failed run.
int run_log(const RunOptions& options);

/// The same with the devices of options.devices or the ROS robot, until the first Ctrl-C, or with
/// options.simulation, until the end of the world's tour; then prints the error against the truth.
int run_devices(RunOptions options);

/// Sends the simulated robot of options.simulation to options.goal in options.job.map and compares
/// with the truth. Throws as above, and std::runtime_error when it does not arrive.
int run_goto(RunOptions options);

/// Checks that the world of options.simulation can be driven through and writes the devices file
/// for the gateway. Throws service::BadInputError and std::runtime_error.
void prepare_simulation(RunOptions& options);

/// Throws service::BadInputError when the world cannot be read or no robot fits at its start.
void check_world(const SimulatorOptions& simulation);

/// The true pose at each time of `poses` that the truth covers.
std::vector<topomap::StampedPose> truth_at(std::span<const topomap::StampedPose> poses,
                                           std::span<const topomap::StampedPose> truth);

/// The report of a run without its wall time and the skipped lines of a log.
storage::Report make_report(const RunOptions& options, const support::EffectiveConfig& config,
                            const RunResult& result);
/// Prints the search workers that took part, and the faults of the localizer.
void print_pool(std::ostream& out, const RunResult& result);

/// Adds --seed, --baud, --odometry, --speed and --people, which need the option `simulation`.
void add_simulation_options(command_line::Command& app, SimulatorOptions& options,
                            command_line::Option* simulation);

/// Adds --goto with its options; it needs the option `needed` unless that is null.
void add_goal_run_options(command_line::Command& app, GoalOptions& options, bool& unknown_start,
                          command_line::Option* needed);

/// Adds --workers, --domain, --rate and --profiles.
void add_run_options(command_line::Command& app, RunOptions& options);

}  // namespace topogeo::cli
