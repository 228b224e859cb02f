// The subcommands of topogeo. Each function adds a subcommand to the program. When the command line
// names this subcommand, it runs and sets `exit_code` (service::ExitCode, or 128 + signal when
// interrupted), or throws service::UsageError, service::BadInputError or std::runtime_error.
#pragma once

#include "topogeo/command_line/command_line.hpp"

namespace topogeo::cli {

/// Exit code of a program that a signal ended, less the number of the signal, as in shells.
inline constexpr int kSignalBase = 128;

void add_run_command(command_line::Command& app, int& exit_code);
void add_map_command(command_line::Command& app, int& exit_code);
void add_match_command(command_line::Command& app, int& exit_code);
void add_reproduce_command(command_line::Command& app, int& exit_code);
void add_localize_command(command_line::Command& app, int& exit_code);
void add_localizer_command(command_line::Command& app, int& exit_code);
void add_base_command(command_line::Command& app, int& exit_code);
void add_record_command(command_line::Command& app, int& exit_code);
void add_check_log_command(command_line::Command& app, int& exit_code);
void add_convert_command(command_line::Command& app, int& exit_code);
void add_demo_command(command_line::Command& app, int& exit_code);
void add_simulator_command(command_line::Command& app, int& exit_code);
void add_status_command(command_line::Command& app, int& exit_code);
void add_workers_command(command_line::Command& app, int& exit_code);
void add_top_command(command_line::Command& app, int& exit_code);
void add_devices_command(command_line::Command& app, int& exit_code);
void add_doctor_command(command_line::Command& app, int& exit_code);
void add_follow_command(command_line::Command& app, int& exit_code);
void add_explore_command(command_line::Command& app, int& exit_code);
void add_goto_command(command_line::Command& app, int& exit_code);
void add_draw_command(command_line::Command& app, int& exit_code);
void add_places_command(command_line::Command& app, int& exit_code);
void add_plan_command(command_line::Command& app, int& exit_code);
void add_simulate_route_command(command_line::Command& app, int& exit_code);
void add_dvl_command(command_line::Command& app, int& exit_code);
void add_config_command(command_line::Command& app, int& exit_code);
void add_calibrate_laser_command(command_line::Command& app, int& exit_code);
void add_calibrate_odometry_command(command_line::Command& app, int& exit_code);
void add_compare_command(command_line::Command& app, int& exit_code);
void add_web_command(command_line::Command& app, int& exit_code);
void add_view_command(command_line::Command& app, int& exit_code);
void add_store_command(command_line::Command& app, int& exit_code);

}  // namespace topogeo::cli
