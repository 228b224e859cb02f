#include "common/job.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"
#include "common/map_or_grid.hpp"

namespace topogeo::cli {
namespace {

constexpr std::size_t kLongestRobotId = 32;  // bytes, idl

Job open_log(const JobOptions& options, Inputs inputs) {
  try {
    recording::LogReader reader(options.log, inputs.config.config.log, options.topics);
    report_no_return(reader);
    const std::uint64_t laser_lines = reader.scan_count();
    return {options, std::move(inputs), std::move(reader), laser_lines};
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

/// A map is continued with the mounting that it was made with, which no search finds exactly.
void mount_as_in_map(pipeline::LoadedConfig& config, JobOptions& options) {
  const storage::MapDocument map = storage::read_map_file(*options.continued);
  if (map.local_maps.empty()) return;
  const geometry::Pose2& T_robot_laser = map.local_maps.front().T_robot_laser;
  std::cerr << fmt::format("topogeo: laser {}: as in {}\n",
                           pipeline::mounting_argument(T_robot_laser), options.continued->string());
  set_mounting(config, T_robot_laser);
  options.topics.T_robot_laser = T_robot_laser;
}

/// Summary of the stops of a drive in a finished map; empty for a mapping.
std::string localization_line(const storage::Report& report) {
  if (report.localization.empty()) return {};
  std::string line = "localization:";
  for (const auto& [state, count] : report.localization) {
    line += fmt::format("{} {} {}", line.back() == ':' ? "" : ",", count, state);
  }
  return line + "\n";
}

/// Summary of an extended map; empty otherwise.
std::string continuation_line(const storage::Report& report) {
  if (report.continuation.empty()) return {};
  std::string line = "continued map:";
  for (const auto& [name, count] : report.continuation) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    line += fmt::format("{} {} {}", line.back() == ':' ? "" : ",", count, words);
  }
  return line + "\n";
}

std::uint64_t scans_without_odometry(const scan::CarmenLogStatistics& statistics) {
  return statistics.skipped_for(scan::SkipReason::kNoOdometry) +
         statistics.skipped_for(scan::SkipReason::kOdometryEnds);
}

void print_error(std::ostream& out, const char* name, const pipeline::TrajectoryError& error) {
  out << fmt::format("  {:<10} {:8.3f} m rms {:8.3f} m largest {:8.2f} deg heading", name,
                     error.rms_m, error.largest_m, error.heading_rad * 180.0 / std::numbers::pi);
  if (error.loop) out << fmt::format(" {:8.3f} m in loops", error.loop->mean_m);
  out << '\n';
}

}  // namespace

void add_config_option(command_line::Command& app, std::optional<std::filesystem::path>& config) {
  app.add_option("--config", config, "configuration (YAML); see `topogeo config`")
      ->type_name("FILE");
}

void add_width_option(command_line::Command& app, std::uint32_t& width_px) {
  app.add_option("--width", width_px, "width of the picture, pixels")
      ->check(command_line::range(400U, 16384U))
      ->type_name("PX")
      ->capture_default_str();
}

void add_common_options(command_line::Command& app, JobOptions& options) {
  add_config_option(app, options.config);
  app.add_option("--robot,--robot-id", options.robot_id, "name of the robot, up to 32 bytes")
      ->environment("TOPOGEO_ROBOT")
      ->check([](const std::string& id) {
        return id.empty() || id.size() > kLongestRobotId ? "expected 1 to 32 bytes" : "";
      })
      ->type_name("ID")
      ->capture_default_str();
}

void add_topic_options(command_line::Command& app, recording::TopicChoice& topics) {
  app.add_option_function(
         "--sweep", [&topics](const std::string& order) { topics.sweep = ros::sweep_order(order); },
         "for a ROS recording: correct the motion during a scan by time_increment, with the first "
         "ray first (forward) or, as in many clockwise scanners, the last ray first (backward)")
      ->check(command_line::one_of({"none", "forward", "backward"}));
  app.add_option("--scan-topic", topics.scan,
                 "topic of the laser scans in a recording (default: of a level laser, /scan, else "
                 "the one with most messages)")
      ->type_name("TOPIC");
  app.add_option("--odometry-topic", topics.odometry,
                 "topic of the odometry or transforms in a recording (default: of the robot with "
                 "these scans, /odom, else the one with most messages, else odom -> base_link of "
                 "/tf); also of PoseStamped, PoseWithCovarianceStamped or TransformStamped")
      ->type_name("TOPIC");
  app.add_option_function(
         "--laser",
         [&topics](const std::string& text) {
           topics.T_robot_laser = pipeline::parse_mounting(text);
         },
         "mounting of the laser on the robot, m and rad; overrides configuration and log (default: "
         "as they state, else found from the scans of a recording)")
      ->check([](const std::string& text) -> std::string {
        try {
          static_cast<void>(pipeline::parse_mounting(text));
          return {};
        } catch (const std::exception& error) {
          return error.what();
        }
      })
      ->type_name("X,Y,YAW");
  app.add_option("--scan-delay", topics.scan_delay_s,
                 "time by which the stamps of the scans in a recording are later than those of the "
                 "odometry (default: 0.1 s or more are found from turns, else 0)")
      ->check(command_line::range(-10.0, 10.0))
      ->type_name("S");
  app.add_flag("--upside-down", topics.upside_down,
               "the laser hangs upside down, or its driver mirrors the scans; for a log that does "
               "not state it");
}

void add_log_options(command_line::Command& app, JobOptions& options) {
  app.add_option("log,--log", options.log, recording::kLogFormats)->required()->type_name("FILE");
  add_topic_options(app, options.topics);
  app.add_option("--out", options.out, "directory for the results; created if missing")
      ->required()
      ->type_name("DIR");
  add_common_options(app, options);
  app.add_option("--reference", options.reference,
                 "trajectory (TUM) to compare the result with at the end")
      ->type_name("FILE");
}

void add_overlaps_option(command_line::Command& app, JobOptions& options) {
  app.add_flag("--overlaps", options.overlaps,
               "add to report.json, for each stop, the earlier stops with the same view, and the "
               "solutions of a search in each stop that it was matched with");
}

void add_overlaps(storage::Report& report, const JobOptions& options,
                  const pipeline::Config& config) {
  if (!options.overlaps && !config.report.overlaps) return;
  std::cerr << "searching matched stops for the report\n";
  const storage::MapDocument map = storage::read_map_file(options.out / "map.pb");
  results::add_overlaps(report, pipeline::stop_overlaps(map, config.localizer));
}

void add_map_options(command_line::Command& app, JobOptions& options, StoredMapUse use) {
  command_line::Option* map = nullptr;
  if (use != StoredMapUse::kExtendMap) {
    map = app.add_option("--map", options.map,
                         use == StoredMapUse::kLocalize
                             ? "map to localize in, read-only: map.pb, or the YAML of a grid"
                             : "map.pb to localize in, read-only")
              ->type_name("FILE");
  }
  if (use == StoredMapUse::kLocalize) map->required();
  if (use != StoredMapUse::kLocalize) {
    command_line::Option* continued =
        app.add_option("--continue", options.continued,
                       "map.pb to extend: the robot is localized in it, then maps on; the file is "
                       "not changed, the whole map is written to --out")
            ->type_name("FILE");
    if (map != nullptr) map->excludes(continued);
  }
  app.add_option(
         "--initial-pose", options.initial_pose,
         "initial pose of the log in that map, m and degrees (default: search the whole map)")
      ->check([](const std::string& text) -> std::string {
        try {
          static_cast<void>(pipeline::parse_pose(text));
          return {};
        } catch (const std::invalid_argument& error) {
          return error.what();
        }
      })
      ->type_name("X,Y,DEG");
}

Inputs check_inputs(JobOptions& options) {
  if (options.initial_pose && !options.map && !options.continued) {
    throw service::UsageError("--initial-pose: expected with a stored map, --map or --continue");
  }
  Inputs inputs{load(options.config), nullptr, nullptr, {}};
  if (!options.log.empty()) {
    inputs.mounting = choose_mounting(inputs.config, options.log, options.topics);
    if (!inputs.mounting.refusal.empty()) {
      throw service::BadInputError(options.log.string() + ": " + inputs.mounting.refusal);
    }
    if (inputs.mounting.found && options.continued) mount_as_in_map(inputs.config, options);
  }
  const pipeline::Config& config = inputs.config.config;
  if (options.continued && config.localizer.mode != localization::SlamAlgorithm::kGraph) {
    throw service::UsageError("--continue: expected localizer.mode graph in the configuration");
  }
  try {
    if (options.reference) (void)storage::read_trajectory_tum(*options.reference);
    if (options.map) {
      inputs.map = options.map_may_be_grid ? load_map_or_grid(*options.map, config)
                                           : pipeline::load_stored_map(*options.map);
    }
    if (options.continued) {
      inputs.continued =
          pipeline::load_map_to_continue(*options.continued, config, options.robot_id);
    }
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  return inputs;
}

Job prepare(JobOptions options) {
  Inputs inputs = check_inputs(options);
  Job job = open_log(options, std::move(inputs));
  support::check_writable_directory(options.out);
  return job;
}

void report_no_return(const recording::LogReader& reader) {
  if (!reader.no_return()) return;
  std::cerr << "topogeo: " << text_of(*reader.no_return()) << '\n';
}

void report_skipped(const scan::CarmenLogStatistics& statistics) {
  print_notes(statistics.notes);
  if (statistics.skipped_total() == 0) return;
  for (const std::string& message : statistics.messages) std::cerr << message << '\n';
  std::cerr << statistics.summary() << '\n';
}

void check_usable(const JobOptions& options, const scan::CarmenLogStatistics& statistics) {
  constexpr std::uint64_t kFewest = 10;      // a shorter log says little
  constexpr std::uint64_t kLeastShare = 10;  // one scan of so many
  const std::uint64_t skipped = statistics.skipped_total();
  const std::uint64_t all = statistics.scans + skipped;
  if (all < kFewest || statistics.scans * kLeastShare >= all) return;
  const std::string first = statistics.messages.empty() ? "" : "; " + statistics.messages.front();
  throw service::BadInputError(fmt::format("{}: only {} of {} scans are usable{}",
                                           options.log.string(), statistics.scans, all, first));
}

void add_mounting(storage::Report& report, const Inputs& inputs) {
  if (!inputs.mounting.found) return;
  const localization::FoundMounting& found = *inputs.mounting.found;
  report.laser = {true,
                  found.T_robot_laser,
                  found.heading_known,
                  found.position_known,
                  found.upside_down,
                  found.heading_spread_rad,
                  found.position_spread_m,
                  found.confidence(),
                  found.motions,
                  found.fitting};
}

void add_quality(storage::Report& report, const Job& job, const storage::MapDocument& document,
                 const MappingFacts& facts) {
  if (job.options.map || job.options.continued) return;
  results::add_quality(
      report, document,
      {job.options.log.string(), job.inputs.mounting.known,
       job.inputs.config.config.localizer.recent_matches, facts.unmapped_stops, facts.tried,
       scans_without_odometry(job.reader.statistics()), job.inputs.config.range_scale_set});
}

void print_summary(std::ostream& out, const storage::Report& report,
                   const std::filesystem::path& directory) {
  // A localized robot has no pose before it is found.
  out << fmt::format("{}: {} {}, {} stops, {:.1f} m of path, {} loop closures\n",
                     std::filesystem::path(report.log).filename().string(), report.scans,
                     report.command == "localize" ? "poses" : "scans", report.stops,
                     report.distance_m, report.loop_closures.size())
      << fmt::format("map: {} nodes, {} branches; {} of {} matches accepted\n", report.nodes,
                     report.branches, report.matches_accepted, report.matches_tried)
      << localization_line(report) << continuation_line(report) << results::quality_text(report)
      << fmt::format("time: {:.1f} s, CPU {:.1f} s\n", report.wall_s, report.cpu_s) << "results in "
      << directory.string() << ", picture " << (directory / "map.png").string() << '\n';
}

Comparison compare(const std::filesystem::path& directory, const std::filesystem::path& reference) {
  const auto truth = storage::read_trajectory_tum(reference);
  const auto odometry = storage::read_trajectory_tum(directory / "odometry.tum");
  const std::filesystem::path trajectory = directory / "trajectory.tum";
  const auto corrected = storage::read_trajectory_tum(trajectory);
  try {
    return {pipeline::trajectory_error(odometry, truth),
            pipeline::trajectory_error(corrected, truth)};
  } catch (const std::invalid_argument& error) {  // other times
    throw service::BadInputError(fmt::format(
        "the results are written, but {} cannot be compared with them: {}; `topogeo compare {} {} "
        "--max-dt SECONDS` pairs poses that are further apart in time",
        reference.string(), error.what(), trajectory.string(), reference.string()));
  }
}

void print_comparison(std::ostream& out, const Comparison& comparison) {
  out << "position error after the best rigid alignment, over " << comparison.corrected.pairs
      << " poses, and mean heading error (more: topogeo compare):\n";
  print_error(out, "odometry", comparison.odometry);
  print_error(out, "corrected", comparison.corrected);
}

}  // namespace topogeo::cli
