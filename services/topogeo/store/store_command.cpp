// topogeo store: maps as files.
#include "topogeo/command_line/command_line.hpp"

#include "commands.hpp"
#include "store/store_commands.hpp"

namespace topogeo::cli {

void add_store_command(command_line::Command& app, int& exit_code) {
  command_line::Command* store =
      app.add_subcommand("store", "Show, check, convert, join and keep map files and databases");
  store->require_subcommand(1);
  store->footer(
      "A FILE is a map file (map.pb) or a map database (map.sqlite); the content decides.");
  add_store_inspect_commands(*store, exit_code);
  add_store_export_command(*store, exit_code);
  add_store_import_command(*store, exit_code);
  add_store_join_commands(*store, exit_code);
  add_store_merge_commands(*store, exit_code);
  add_store_prune_command(*store, exit_code);
  add_store_snapshot_commands(*store, exit_code);
}

}  // namespace topogeo::cli
