// The subcommands of `topogeo store`, added like those of commands.hpp.
#pragma once

#include "topogeo/command_line/command_line.hpp"

namespace topogeo::cli {

void add_store_inspect_commands(command_line::Command& store, int& exit_code);
void add_store_export_command(command_line::Command& store, int& exit_code);
void add_store_import_command(command_line::Command& store, int& exit_code);
void add_store_join_commands(command_line::Command& store, int& exit_code);
void add_store_merge_commands(command_line::Command& store, int& exit_code);
void add_store_prune_command(command_line::Command& store, int& exit_code);
void add_store_snapshot_commands(command_line::Command& store, int& exit_code);

}  // namespace topogeo::cli
