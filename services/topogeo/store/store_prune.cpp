// topogeo store prune: drops dispensable parts of a map.
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/prune.hpp"
#include "topogeo/exchange/sessions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"
#include "common/job.hpp"
#include "store/store_commands.hpp"
#include "store/store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct PruneOptions {
  fs::path file;
  std::optional<fs::path> out;
  std::optional<fs::path> config;
  std::optional<std::size_t> keep;
  double older_than_days = 0.0;
  bool dry_run = false;
};

int prune_map_file(const PruneOptions& options) {
  if (!options.keep || (!options.out && !options.dry_run)) {
    throw service::UsageError(options.file.string() +
                              ": a map file has no waiting stops; expected --keep N and --out MAP");
  }
  const pipeline::Config config = read_config(options.config);
  const storage::MapDocument map = read_any_map(options.file);
  const storage::MapDocument fewer =
      exchange::with_fewer_views(map, *options.keep, config.global_map);
  if (!options.dry_run) storage::write_map_file(*options.out, fewer);
  std::cout << fmt::format("{} of {} views {}\n", map.local_maps.size() - fewer.local_maps.size(),
                           map.local_maps.size(), options.dry_run ? "would go" : "dropped");
  return service::kOk;
}

int store_prune(const PruneOptions& options) {
  if (!looks_like_database(options.file)) return prune_map_file(options);
  if (options.out) {
    throw service::UsageError("--out: a map database is pruned in its place; copy it first");
  }
  constexpr double kDay_ns = 86400e9;
  exchange::PruneSettings settings;
  settings.older_ns = static_cast<std::int64_t>(options.older_than_days * kDay_ns);
  settings.times = options.keep;
  settings.dry_run = options.dry_run;
  const pipeline::Config config = read_config(options.config);
  const exchange::Pruned pruned = [&] {
    try {
      return exchange::prune(options.file, settings, config.global_map);
    } catch (const std::exception& error) {
      throw service::BadInputError(error.what());
    }
  }();
  const char* what = options.dry_run ? "would go" : "dropped";
  for (const exchange::PrunedSession& session : pruned.sessions) {
    std::cout << fmt::format("session    {}: {} waiting stops {}\n",
                             exchange::session_text(session.session), session.stops, what);
  }
  std::cout << fmt::format("views      {} of {} {}\n", pruned.views_before - pruned.views,
                           pruned.views_before, what);
  if (options.dry_run) return service::kOk;
  std::cout << fmt::format("size       {} bytes, {} before\n", pruned.bytes, pruned.bytes_before);
  return service::kOk;
}

}  // namespace

void add_store_prune_command(command_line::Command& store, int& exit_code) {
  constexpr double kMostTimes = 1000.0;
  constexpr double kMostDays = 36500.0;
  command_line::Command* command =
      store.add_subcommand("prune", "Remove stops that never joined a map, and redundant views");
  auto options = std::make_shared<PruneOptions>();
  command->add_option("file", options->file, "map database, or map file with --keep and --out")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--keep", options->keep, "number of views to keep of each place; default: all")
      ->check(command_line::range(1.0, kMostTimes))
      ->type_name("N");
  command
      ->add_option(
          "--older-than", options->older_than_days,
          "only sessions that ended this long before the newest stop; default: all but the newest")
      ->check(command_line::range(0.0, kMostDays))
      ->type_name("DAYS");
  command->add_flag("--dry-run", options->dry_run, "print what would be removed, change nothing");
  command->add_option("--out", options->out, "map file to write (map.pb)")->type_name("MAP");
  add_config_option(*command, options->config);
  command->footer(
      "Stop the map store before its database is pruned: a running one keeps the old content.\n"
      "Exit codes: 0 done, 3 unusable input.");
  command->callback([options, &exit_code] { exit_code = store_prune(*options); });
}

}  // namespace topogeo::cli
