// The subcommands of topogeo. Each function adds one to the program; when the command line names
// it, it does its work and sets `exit_code` (service::ExitCode, or 128 + signal when interrupted),
// or throws service::UsageError, service::BadInputError or std::runtime_error.
#pragma once

#include <CLI/App.hpp>

namespace topogeo::cli {

/// Exit code of a program that a signal has ended, less the signal, as in shells.
inline constexpr int kSignalBase = 128;

void add_run_command(CLI::App& app, int& exit_code);
void add_map_command(CLI::App& app, int& exit_code);
void add_localize_command(CLI::App& app, int& exit_code);
void add_localizer_command(CLI::App& app, int& exit_code);
void add_base_command(CLI::App& app, int& exit_code);
void add_record_command(CLI::App& app, int& exit_code);
void add_check_log_command(CLI::App& app, int& exit_code);
void add_demo_command(CLI::App& app, int& exit_code);
void add_simulator_command(CLI::App& app, int& exit_code);
void add_status_command(CLI::App& app, int& exit_code);
void add_workers_command(CLI::App& app, int& exit_code);
void add_explore_command(CLI::App& app, int& exit_code);
void add_goto_command(CLI::App& app, int& exit_code);
void add_places_command(CLI::App& app, int& exit_code);
void add_plan_command(CLI::App& app, int& exit_code);
void add_simulate_route_command(CLI::App& app, int& exit_code);
void add_dvl_command(CLI::App& app, int& exit_code);
void add_config_command(CLI::App& app, int& exit_code);
void add_calibrate_laser_command(CLI::App& app, int& exit_code);
void add_calibrate_odometry_command(CLI::App& app, int& exit_code);
void add_compare_command(CLI::App& app, int& exit_code);

}  // namespace topogeo::cli
