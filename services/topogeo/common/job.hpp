// Inputs and outputs of mapping a log, in one process or in many.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/results/map_quality.hpp"
#include "topogeo/storage/report.hpp"

#include "common/log_mounting.hpp"

namespace topogeo::cli {

struct JobOptions {
  std::filesystem::path log;
  recording::TopicChoice topics;  ///< for a ROS recording
  std::filesystem::path out;
  std::optional<std::filesystem::path> config;
  std::string robot_id = "robot";
  std::optional<std::filesystem::path> reference;  ///< true trajectory for comparison
  bool map_may_be_grid = false;                    ///< --map may be a grid, which gets stops
  std::optional<std::filesystem::path> map;        ///< map to localize in; empty: a map is made
  std::optional<std::filesystem::path> continued;  ///< map to extend; empty: a new map
  std::optional<std::string> initial_pose;         ///< "x,y,degrees" in either map
  bool overlaps = false;  ///< in the report, even if the configuration does not ask for them
};

/// Adds --config.
void add_config_option(command_line::Command& app, std::optional<std::filesystem::path>& config);
/// Adds --width, for a picture.
void add_width_option(command_line::Command& app, std::uint32_t& width_px);
/// Adds --config and --robot, common to all mapping commands.
void add_common_options(command_line::Command& app, JobOptions& options);
/// Adds the options on topics, and on a mounting that the log does not state.
void add_topic_options(command_line::Command& app, recording::TopicChoice& topics);
/// Adds --overlaps, for commands that make a map.
void add_overlaps_option(command_line::Command& app, JobOptions& options);
/// Adds --log with its topic options, --out and --reference.
void add_log_options(command_line::Command& app, JobOptions& options);

/// The options on stored maps that a command has.
enum class StoredMapUse : std::uint8_t {
  kLocalize,   ///< --map, which is required
  kExtendMap,  ///< --continue
  kEither,     ///< both, of which one may be given
};

/// Adds those options and --initial-pose.
void add_map_options(command_line::Command& app, JobOptions& options, StoredMapUse use);

/// Inputs of mapping besides scans.
struct Inputs {
  pipeline::LoadedConfig config;
  std::shared_ptr<const localization::StoredMap> map;     ///< of JobOptions::map
  std::shared_ptr<const storage::MapDocument> continued;  ///< of JobOptions::continued
  MountingChoice mounting;                                ///< with a log
};

/// Checks before the work starts that configuration, stored map and reference are usable, whatever
/// the source of the scans; with a log, the laser mounting and `options.topics` are those of
/// choose_mounting. Throws service::UsageError for options and configuration,
/// service::BadInputError for the rest.
Inputs check_inputs(JobOptions& options);

struct Job {
  JobOptions options;
  Inputs inputs;
  recording::LogReader reader;    ///< before its first scan
  std::uint64_t laser_lines = 0;  ///< upper bound of the number of usable scans
};

/// Opens a log, checks the same and makes the output directory. Throws the same, and
/// std::runtime_error for the directory.
Job prepare(JobOptions options);

/// Adds overlap sets and solutions to a report if they are asked for, from the map.pb that was
/// written.
void add_overlaps(storage::Report& report, const JobOptions& options,
                  const pipeline::Config& config);

/// Reports the range that means "no echo" on stderr, if the log has one.
void report_no_return(const recording::LogReader& reader);

/// Reports the skipped parts of the log and faults of its odometry on stderr, if there are any.
void report_skipped(const scan::CarmenLogStatistics& statistics);

/// Throws service::BadInputError if nearly all scans of a log were skipped.
void check_usable(const JobOptions& options, const scan::CarmenLogStatistics& statistics);

/// Adds the mounting that was found from the scans, if it was searched.
void add_mounting(storage::Report& report, const Inputs& inputs);

/// Facts on a map that are in neither its file nor its report.
struct MappingFacts {
  std::uint64_t unmapped_stops = 0;  ///< of a robot that was not found again in its map
  std::set<results::Remedy> tried{};
};

/// Grades a new map by the counts of its report, for print_summary.
void add_quality(storage::Report& report, const Job& job, const storage::MapDocument& document,
                 const MappingFacts& facts = {});

/// A few lines for people: mapped stops, time taken, place of the results.
void print_summary(std::ostream& out, const storage::Report& report,
                   const std::filesystem::path& directory);

/// Compares odometry.tum and trajectory.tum of a directory with a reference trajectory.
struct Comparison {
  pipeline::TrajectoryError odometry;
  pipeline::TrajectoryError corrected;
};
/// Throws std::runtime_error naming an unreadable file, std::invalid_argument when too few poses
/// match in time.
Comparison compare(const std::filesystem::path& directory, const std::filesystem::path& reference);
void print_comparison(std::ostream& out, const Comparison& comparison);

}  // namespace topogeo::cli
