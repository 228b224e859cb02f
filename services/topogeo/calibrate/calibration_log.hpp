// Shared by the calibration commands: a log as local maps with matches between recent stops.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/support/progress_bar.hpp"

namespace topogeo::cli {

/// The configuration of the file or the defaults, with the laser mounting of choose_mounting;
/// checks that `out`, if given, can be written. Throws service::UsageError, service::BadInputError
/// for the log and std::runtime_error for `out`.
pipeline::LoadedConfig load_for_calibration(const std::optional<std::filesystem::path>& config,
                                            const std::optional<std::filesystem::path>& out,
                                            const std::filesystem::path& log,
                                            recording::TopicChoice& topics);

/// A log before its first scan.
struct OpenLog {
  recording::LogReader reader;
  std::uint64_t laser_lines = 0;  ///< upper bound of the number of usable scans
};
/// Opens the log. Throws service::BadInputError if it cannot be read.
OpenLog open_log(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                 const recording::TopicChoice& topics);

/// A progress bar on stderr if that is a terminal, else a line that names the work.
class Bar {
 public:
  Bar(const char* label, const char* unit);
  void update(std::uint64_t done, std::uint64_t total);
  void finish();

 private:
  support::ProgressBar bar_;
  double start_s_;
  std::uint64_t done_ = 0;
};

/// Makes the local maps of the log. If the odometry breaks, only its longest part is used, because
/// a motion across a break measures nothing.
localization::LocalMaps make_maps(const pipeline::Config& config, OpenLog& log);

struct MatchedLog {
  localization::LocalMaps maps;
  localization::MatchedMotions matched;
};
/// Makes the local maps and matches each with some recent ones. Closing loops would cost as much
/// again and adds nothing about single steps.
MatchedLog match_log(const pipeline::Config& config, OpenLog& log);

/// Text for people: "52 stops, 41.3 m of path, 30.2 rad of turn".
std::string describe_drive(const localization::LocalMaps& maps);
/// Text for people: "312 matches of stops up to 6 m apart; left out: 3 that ...".
std::string describe_matches(const pipeline::Config& config,
                             const localization::MatchedMotions& matched);

/// Text of a configuration for `topogeo map`. Without `config` it is the block after a comment,
/// else all values of `config`, with those of the block replaced and the laser mounting unchanged.
/// Throws std::runtime_error naming file and line.
std::string configuration_with(const std::string& block, const std::string& comment,
                               const std::optional<std::filesystem::path>& config,
                               const geometry::Pose2& T_robot_laser);

}  // namespace topogeo::cli
