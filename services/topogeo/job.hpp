// What mapping a log needs and leaves behind, whether in one process or in many.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/storage/report.hpp"

namespace topogeo::cli {

struct JobOptions {
  std::filesystem::path log;
  recording::TopicChoice topics;  ///< of a log that is a recording of ROS
  std::filesystem::path out;
  std::optional<std::filesystem::path> config;
  std::string robot_id = "robot";
  std::optional<std::filesystem::path> reference;  ///< trajectory to compare with
  std::optional<std::filesystem::path> map;        ///< to localize in; none: a map is made
  std::optional<std::filesystem::path> continued;  ///< map to extend; none: one is begun
  std::optional<std::string> initial_pose;         ///< "x,y,degrees" in either
  bool overlaps = false;  ///< in the report, also where the configuration does not ask for them
};

/// Adds --config.
void add_config_option(command_line::Command& app, std::optional<std::filesystem::path>& config);
/// Adds --width, of a picture.
void add_width_option(command_line::Command& app, std::uint32_t& width_px);
/// Adds --config and --robot, which every mapping command has.
void add_common_options(command_line::Command& app, JobOptions& options);
/// Adds --scan-topic and --odometry-topic.
void add_topic_options(command_line::Command& app, recording::TopicChoice& topics);
/// Adds --overlaps, of the commands that make a map.
void add_overlaps_option(command_line::Command& app, JobOptions& options);
/// Adds --log, those of its topics, --out and --reference as well.
void add_log_options(command_line::Command& app, JobOptions& options);

/// Which options on stored maps a command has.
enum class StoredMapUse : std::uint8_t {
  kLocalize,  ///< --map, which is required
  kContinue,  ///< --continue
  kEither,    ///< both, one of which may be given
};

/// Adds them and --initial-pose.
void add_map_options(command_line::Command& app, JobOptions& options, StoredMapUse use);

/// What mapping needs besides scans.
struct Inputs {
  pipeline::LoadedConfig config;
  std::shared_ptr<const localization::StoredMap> map;     ///< of JobOptions::map
  std::shared_ptr<const storage::MapDocument> continued;  ///< of JobOptions::continued
};

/// Takes the mounting of the laser from the log unless the configuration sets it, and reports on
/// stderr what people should know of that, and of the topics that are used of a recording. Throws
/// service::BadInputError when the log cannot be opened.
void choose_mounting(pipeline::LoadedConfig& config, const std::filesystem::path& log,
                     const recording::TopicChoice& topics);

/// Finds out before the work starts whether configuration, stored map and reference can be used,
/// wherever the scans come from; where there is a log, with the laser where choose_mounting has it.
/// Throws service::UsageError for options and configuration,
/// service::BadInputError for the others.
Inputs check_inputs(const JobOptions& options);

struct Job {
  JobOptions options;
  Inputs inputs;
  recording::LogReader reader;    ///< before its first scan
  std::uint64_t laser_lines = 0;  ///< at least as many as there are usable scans
};

/// The same for a log, which it opens, and makes the output directory. Throws the same, and
/// std::runtime_error for the directory.
Job prepare(const JobOptions& options);

/// Fills the overlap sets and solutions of a report where they are asked for, by the map.pb that
/// was written.
void add_overlaps(storage::Report& report, const JobOptions& options,
                  const pipeline::Config& config);

/// Reports on stderr what was left out of the log; nothing when that is nothing.
void report_skipped(const scan::CarmenLogStatistics& statistics);

/// A few lines for people: how much was mapped, how long it took, where the results are.
void print_summary(std::ostream& out, const storage::Report& report,
                   const std::filesystem::path& directory);

/// Compares odometry.tum and trajectory.tum of a directory with a reference trajectory.
struct Comparison {
  pipeline::TrajectoryError odometry;
  pipeline::TrajectoryError corrected;
};
/// Throws std::runtime_error naming the file that cannot be read, std::invalid_argument when too
/// few poses match in time.
Comparison compare(const std::filesystem::path& directory, const std::filesystem::path& reference);
void print_comparison(std::ostream& out, const Comparison& comparison);

}  // namespace topogeo::cli
