// topogeo run: maps a log with all services as processes on DDS.
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/service/replay_rate.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "commands.hpp"
#include "common/log_odometry.hpp"
#include "common/reliability.hpp"
#include "run/run_log.hpp"
#include "run/run_supervisor.hpp"
#include "web/web_run.hpp"

namespace topogeo::cli {
namespace {

void add_matches(storage::Report& report, const msg::RunSummary& summary) {
  report.matches_tried = summary.matches_tried();
  report.matches_accepted = summary.matches_accepted();
  for (const msg::ReasonCount& count : summary.matches_rejected()) {
    const auto reason = static_cast<localization::Reason>(count.reason());
    report.matches_rejected.emplace_back(localization::to_string(reason), count.matches());
  }
}

/// Stops by state, and searches, under the names of pipeline::localization_counts.
void add_localization(storage::Report& report, const msg::RunSummary& summary) {
  for (const msg::StateCount& count : summary.stops_by_state()) {
    const auto state = static_cast<localization::LocalizationState>(count.state());
    report.localization.emplace_back(localization::to_string(state), count.stops());
  }
  report.localization.emplace_back("searches", summary.searches());
}

/// Stops of a continued map, under the names of pipeline::continuation_counts.
void add_continuation(storage::Report& report, const msg::RunSummary& summary) {
  report.continuation = {{"stored_stops", summary.stored_stops()},
                         {"added_stops", summary.added_stops()},
                         {"unmapped_stops", summary.unmapped_stops()}};
  const std::string message = summary.message().to_string();
  if (!message.empty()) std::cerr << "topogeo: " << message << '\n';
}

/// Sets the start of a simulated robot with a goal: the origin of the map, unless a flag gives
/// another place.
RunOptions with_start(RunOptions options, bool unknown) {
  if (!options.job.map && options.goal) {
    throw service::UsageError("run: --goto needs --map (see --help)");
  }
  if (unknown && options.job.initial_pose) {
    throw service::UsageError("run: --unknown-start excludes --initial-pose");
  }
  if (options.job.map && !unknown && !options.job.initial_pose) options.job.initial_pose = "0,0,0";
  return options;
}

std::string check_rate(const std::string& text) {
  try {
    static_cast<void>(service::parse_rate(text));
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

}  // namespace

storage::Report make_report(const RunOptions& options, const support::EffectiveConfig& config,
                            const RunResult& result) {
  storage::Report report;
  report.command = "run";
  report.log = source_name(options);
  report.workers = options.workers;
  report.configuration = config;
  results::add_map(report, storage::read_map_file(options.job.out / "map.pb"));
  add_matches(report, result.summary);
  results::add_loop_candidates(report, result.loop_decisions);
  if (options.job.map) add_localization(report, result.summary);
  if (options.job.continued) add_continuation(report, result.summary);
  report.stages = result.times;
  for (const support::StageTime& time : result.times) report.cpu_s += time.cpu_s;
  report.cpu_s += support::process_cpu_s();
  return report;
}

void print_pool(std::ostream& out, const RunResult& result) {
  const msg::RunSummary& summary = result.summary;
  out << "search: " << summary.matches_tried() << " matches, " << summary.tasks_in_process()
      << " in the localizer's process";
  if (summary.tasks_sent() > 0) {
    out << ", " << summary.tasks_sent() << " sent to workers (" << summary.tasks_resent()
        << " of them again)";
  }
  if (summary.workers_lost() > 0) {
    out << "; " << summary.workers_lost()
        << " workers lost with tasks in hand, answered elsewhere after "
        << static_cast<std::uint64_t>(summary.longest_recovery_ms()) << " ms at most";
  }
  out << '\n';
  const msg::ServiceStatus* localizer = result.services.find("localizer");
  if (localizer == nullptr) return;
  for (const msg::FaultCount& fault : localizer->faults()) {
    out << "fault of the localizer: " << fault.reason().c_str() << ", " << fault.count()
        << (fault.count() == 1 ? " time" : " times") << ", see logs/localizer.log\n";
  }
}

void add_run_options(command_line::Command& app, RunOptions& options) {
  app.add_option("--workers", options.workers,
                 "search workers to start; 0: the localizer searches itself")
      ->check(command_line::range(0U, 256U))
      ->capture_default_str();
  app.add_option("--wait-workers", options.wait_workers,
                 "search workers to wait for (5 s) before the first step, those on other machines "
                 "included (default: as many as --workers)")
      ->check(command_line::range(0U, 1024U));
  service::add_domain_option(app, options.domain);
  app.add_option("--rate", options.rate,
                 "replay rate of the log: lossless (as fast as possible), realtime or a factor of "
                 "real time")
      ->check(check_rate)
      ->type_name("RATE")
      ->capture_default_str();
  app.add_option("--profiles", options.profiles_file, "QoS profiles instead of the built-in ones")
      ->type_name("FILE");
  app.add_option(
         "--record", options.record,
         std::string("also record the mapped scans as a log that gives the same map, in the "
                     "format of its ending: ") +
             recording::kWrittenLogs)
      ->check(recording::check_log_name)
      ->type_name("FILE");
}

int run_log(const RunOptions& options) {
  const double start_s = support::monotonic_s();
  Job job = prepare(without_odometry(options.job));
  pipeline::ScanFeed feed = open_feed(job);
  RunOptions mounted = options;
  mounted.job = job.options;  // with what was found of the laser
  mounted.laser = job.inputs.config.config.local_mapper.T_robot_laser;
  const RunResult result = RunSupervisor(mounted, job.laser_lines).run();
  if (result.signal_number != 0) {
    std::cerr << "topogeo: stopped, what was mapped is in " << options.job.out.string() << "\n";
    return kSignalBase + result.signal_number;
  }
  if (!result.finished) throw std::runtime_error(result.failure);

  storage::Report report = make_report(options, job.inputs.config.effective, result);
  add_overlaps(report, options.job, job.inputs.config.config);
  while (feed.next()) {  // to count the lines that the gateway skipped
  }
  results::add_log(report, job.reader.statistics());
  add_odometry(report, feed);
  add_mounting(report, job.inputs);
  add_quality(report, job, storage::read_map_file(options.job.out / "map.pb"));
  report.wall_s = support::monotonic_s() - start_s - result.stayed_s;
  storage::write_report(options.job.out / "report.json", report);
  report_skipped(job.reader.statistics());
  print_pool(std::cout, result);
  print_summary(std::cout, report, options.job.out);
  if (options.job.reference) {
    print_comparison(std::cout, compare(options.job.out, *options.job.reference));
  }
  check_usable(options.job, job.reader.statistics());
  check_tracked(options.job, feed);
  check_reliable(options.job, report);
  return service::kOk;
}

void add_run_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "run", "Map a log, or with real or simulated devices, all services as processes on DDS");
  auto options = std::make_shared<RunOptions>();
  add_log_options(*command, options->job);
  add_map_options(*command, options->job, StoredMapUse::kEither);
  add_overlaps_option(*command, options->job);
  add_run_options(*command, *options);
  command_line::Option* log = command->get_option("--log")->required(false);
  command_line::Option* devices =
      command->add_option("--devices", options->devices, "use the devices of this file (YAML)")
          ->type_name("FILE")
          ->excludes(log);
  auto simulation = std::make_shared<SimulatorOptions>();
  command_line::Option* sim =
      command->add_option("--sim", simulation->world, "drive the tour of this world file (YAML)")
          ->type_name("WORLD")
          ->excludes(log)
          ->excludes(devices);
  add_simulation_options(*command, *simulation, sim);
  command_line::Option* explore =
      command
          ->add_flag("--explore", options->explore,
                     "with --sim or --devices: explore until nothing is left to map")
          ->excludes(log)
          ->excludes(command->get_option("--map"));
  auto web = std::make_shared<WebOptions>();
  auto with_web = std::make_shared<bool>(false);
  command_line::Option* page = command->add_flag("--web", *with_web,
                                                 "open a page in the browser, until Ctrl-C; with "
                                                 "--sim the robot stands until the page sends it");
  add_web_options(*command, *web, page);
  auto ros = std::make_shared<RosOptions>();
  auto joins_ros = std::make_shared<bool>(false);
  command_line::Option* with_ros =
      command->add_flag("--ros", *joins_ros,
                        "connect ROS 2 nodes: alone, map their robot until Ctrl-C; with --log, "
                        "--devices or --sim, publish scans, odometry, map and pose to them");
  add_ros_options(*command, *ros, with_ros);
  auto goal = std::make_shared<GoalOptions>();
  auto unknown_start = std::make_shared<bool>(false);
  add_goal_run_options(*command, *goal, *unknown_start, sim);
  explore->excludes(command->get_option("--goto"));
  command->callback([=, &exit_code] {
    const bool has_source = log->count() + devices->count() + sim->count() > 0;
    if (!has_source && !*joins_ros) {
      throw service::UsageError("run: expected --log, --devices, --sim or --ros (see --help)");
    }
    if (*joins_ros) options->ros = *ros;
    if (sim->count() > 0) options->simulation = *simulation;
    if (*with_web) {
      check_web_options(*web);
      options->web = *web;
    }
    if (*with_web && options->simulation && goal->target.empty() && !options->explore) {
      exit_code = run_web(with_start(*options, *unknown_start));
      return;
    }
    if (!goal->target.empty()) {
      options->goal = *goal;
      exit_code = run_goto(with_start(*options, *unknown_start || simulation->no_laser));
      return;
    }
    if (simulation->no_laser)
      throw service::UsageError("run: --no-laser needs --goto (see --help)");
    exit_code = log->count() > 0 ? run_log(*options) : run_devices(*options);
  });
}

}  // namespace topogeo::cli
