// topogeo map: makes a map from a log in this process, without DDS.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/results/stages.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/progress_bar.hpp"

#include "commands.hpp"
#include "common/job.hpp"
#include "common/log_odometry.hpp"

namespace topogeo::cli {
namespace {

/// Ctrl-C asks the work to end after the current scan. Work that cannot be asked is ended at once,
/// which loses nothing because nothing has been written.
class Interruption {
 public:
  Interruption() : signals_([this](int number) { on_signal(number); }) {}

  /// While it exists, a signal ends the program at once.
  class Immediate {
   public:
    explicit Immediate(Interruption& owner) : owner_(owner) { owner_.set_immediate(true); }
    Immediate(const Immediate&) = delete;
    Immediate& operator=(const Immediate&) = delete;
    ~Immediate() { owner_.set_immediate(false); }

   private:
    Interruption& owner_;
  };

  /// Number of the received signal, 0 if there is none.
  [[nodiscard]] int received() const { return received_; }

 private:
  void set_immediate(bool immediate) {
    const std::lock_guard lock(mutex_);
    immediate_ = immediate;
  }
  void on_signal(int number) {
    const std::lock_guard lock(mutex_);
    received_ = number;
    if (!immediate_) return;
    constexpr std::string_view kText = "\ntopogeo: stopped, nothing was written\n";
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText.data(), kText.size());
    std::_Exit(kSignalBase + number);
  }

  std::mutex mutex_;
  bool immediate_ = false;
  std::atomic<int> received_ = 0;
  messaging::SignalStop signals_;  // last: its thread uses the others
};

/// Takes all scans of the log; false after a signal.
bool add_scans(const Job& job, pipeline::ScanFeed& feed, pipeline::MappingRun& run,
               support::StageTimes& times, const Interruption& interruption) {
  support::ProgressBar bar(std::cerr, support::stderr_is_terminal(), "mapping", "scans");
  const double start_s = support::monotonic_s();
  std::uint64_t done = 0;
  while (interruption.received() == 0) {
    std::optional<scan::Scan> scan;
    {
      const auto scope = times.measure("reading");
      scan = feed.next();
    }
    if (!scan) {
      bar.finish(done, done, support::monotonic_s() - start_s);
      return true;
    }
    run.add(*scan);
    bar.update(++done, job.laser_lines, support::monotonic_s() - start_s);
  }
  bar.finish(done, job.laser_lines, support::monotonic_s() - start_s);
  std::cerr << "topogeo: stopped, nothing was written\n";
  return false;
}

storage::Report make_report(const Job& job, const pipeline::ScanFeed& feed,
                            const pipeline::MappingRun& run, const storage::MapDocument& document) {
  storage::Report report;
  report.command = run.map_tracker() != nullptr ? "localize" : "map";
  report.log = job.options.log.filename().string();
  report.configuration = job.inputs.config.effective;
  results::add_map(report, document);
  results::add_matches(report, run.match_counts());
  results::add_loop_candidates(report, run.loop_decisions());
  results::add_log(report, job.reader.statistics());
  add_odometry(report, feed);
  add_mounting(report, job.inputs);
  add_quality(report, job, document);
  if (run.map_tracker() != nullptr) {
    report.localization = pipeline::localization_counts(*run.map_tracker());
  }
  if (job.inputs.continued) report.continuation = pipeline::continuation_counts(*run.session());
  return report;
}

std::unique_ptr<pipeline::MappingRun> make_run(const Job& job) {
  const JobOptions& options = job.options;
  std::optional<geometry::Pose2> initial_pose;
  if (options.initial_pose) initial_pose = pipeline::parse_pose(*options.initial_pose);
  if (job.inputs.continued) {
    return std::make_unique<pipeline::MappingRun>(job.inputs.config.config, options.robot_id,
                                                  job.inputs.continued, initial_pose);
  }
  if (!job.inputs.map)
    return std::make_unique<pipeline::MappingRun>(job.inputs.config.config, options.robot_id);
  return std::make_unique<pipeline::MappingRun>(job.inputs.config.config, options.robot_id,
                                                job.inputs.map, initial_pose);
}

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
  Job job = prepare(without_odometry(options));
  pipeline::ScanFeed feed = open_feed(job);
  const std::unique_ptr<pipeline::MappingRun> made = make_run(job);
  pipeline::MappingRun& run = *made;
  support::StageTimes times;
  if (!add_scans(job, feed, run, times, interruption)) return kSignalBase + interruption.received();
  report_skipped(job.reader.statistics());
  check_usable(options, job.reader.statistics());
  check_tracked(options, feed);

  if (interruption.received() != 0) return kSignalBase + interruption.received();
  if (!job.inputs.map) std::cerr << "matching revisited places\n";
  storage::MapDocument document;
  {
    const Interruption::Immediate immediate(interruption);
    document = run.finish();
  }
  report_unmapped(run.session());
  {
    const auto scope = times.measure("writing");
    results::write_map_outputs(options.out, document, options.log.filename().string());
    if (run.map_tracker() != nullptr) {
      support::write_file_atomically(options.out / "localization.csv",
                                     pipeline::localization_csv(run.map_tracker()->stops()));
    }
    if (stages) {
      std::cerr << "drawing the stages of the correction\n";
      const Interruption::Immediate immediate(interruption);
      results::write_stage_pictures(options.out, job.inputs.config.config, document,
                                    options.log.filename().string());
    }
  }

  storage::Report report = make_report(job, feed, run, document);
  if (job.inputs.map == nullptr) add_overlaps(report, options, job.inputs.config.config);
  report.stages = times.stages();
  report.stages.insert(report.stages.begin() + 1, run.stages().begin(), run.stages().end());
  report.wall_s = support::monotonic_s() - start_s;
  report.cpu_s = support::process_cpu_s();
  storage::write_report(options.out / "report.json", report);
  print_summary(std::cout, report, options.out);
  if (interruption.received() != 0)
    return kSignalBase + interruption.received();  // the signal came while writing
  if (options.reference) print_comparison(std::cout, compare(options.out, *options.reference));
  check_useful(options, report);
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
