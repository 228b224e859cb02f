// topogeo map: makes a map from a log in this process, without DDS.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/results/stages.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "commands.hpp"
#include "common/job.hpp"
#include "common/log_odometry.hpp"
#include "common/reliability.hpp"
#include "map/interruption.hpp"
#include "map/mapped_log.hpp"

namespace topogeo::cli {
namespace {

/// Reports on stderr why stops are not in the map, if any are missing.
void report_unmapped(const localization::MappingSession* session) {
  if (session == nullptr) return;
  const std::string message = pipeline::continuation_message(*session);
  if (!message.empty()) std::cerr << "topogeo: " << message << '\n';
}

/// Throws for a folder with the database of a map store: its results would mix with ours.
void check_no_database(const std::filesystem::path& out) {
  const std::filesystem::path database = out / "map.sqlite";
  if (!std::filesystem::exists(database)) return;
  throw service::UsageError("'" + database.string() +
                            "' is the map of another run, choose another folder for --out");
}

int map_log(const JobOptions& options, bool stages) {
  const double start_s = support::monotonic_s();
  check_no_database(options.out);
  Interruption interruption;
  std::optional<MappedLog> mapped = map_log_once(prepare(without_odometry(options)), interruption);
  if (mapped) mapped = improved(std::move(*mapped), interruption);
  if (!mapped) return kSignalBase + interruption.received();
  pipeline::MappingRun& run = *mapped->run;
  const storage::MapDocument& document = mapped->document;
  const pipeline::Config& config = mapped->job->inputs.config.config;
  report_unmapped(run.session());
  {
    const auto scope = mapped->times.measure("writing");
    results::write_map_outputs(options.out, document, options.log.filename().string());
    if (run.map_tracker() != nullptr) {
      support::write_file_atomically(options.out / "localization.csv",
                                     pipeline::localization_csv(run.map_tracker()->stops()));
    }
    if (stages) {
      std::cerr << "drawing the stages of the correction\n";
      const Interruption::Immediate immediate(interruption);
      results::write_stage_pictures(options.out, config, document, options.log.filename().string());
    }
  }

  storage::Report& report = mapped->report;
  if (mapped->job->inputs.map == nullptr) add_overlaps(report, options, config);
  report.stages = mapped->times.stages();
  report.stages.insert(report.stages.begin() + 1, run.stages().begin(), run.stages().end());
  report.wall_s = support::monotonic_s() - start_s;
  report.cpu_s = support::process_cpu_s();
  storage::write_report(options.out / "report.json", report);
  print_summary(std::cout, report, options.out);
  if (interruption.received() != 0)
    return kSignalBase + interruption.received();  // the signal came while writing
  if (options.reference) print_comparison(std::cout, compare(options.out, *options.reference));
  check_reliable(mapped->job->options, report);
  return 0;
}

}  // namespace

void add_map_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("map", "Map a log in one process, without DDS");
  auto options = std::make_shared<JobOptions>();
  add_log_options(*command, *options);
  add_map_options(*command, *options, StoredMapUse::kExtendMap);
  add_overlaps_option(*command, *options);
  auto stages = std::make_shared<bool>(false);
  command
      ->add_flag("--stages", *stages,
                 "also draw the map by odometry alone, after forward correction, with its "
                 "cycles closed and at the end: stage_*.png")
      ->excludes(command->get_option("--continue"));
  command->callback([options, stages, &exit_code] { exit_code = map_log(*options, *stages); });
}

void add_localize_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("localize", "Find and follow the robot of a log in a stored map");
  auto options = std::make_shared<JobOptions>();
  options->map_may_be_grid = true;
  add_log_options(*command, *options);
  add_map_options(*command, *options, StoredMapUse::kLocalize);
  command->callback([options, &exit_code] { exit_code = map_log(*options, false); });
}

}  // namespace topogeo::cli
