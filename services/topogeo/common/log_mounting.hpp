// The mounting of the laser of a log, as stated or as the scans show it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/unknown_mounting.hpp"
#include "topogeo/recording/survey.hpp"

namespace topogeo::cli {

/// The mounting of the laser, and its source.
struct MountingChoice {
  bool known = false;  ///< stated by flag, configuration or log, or found with its heading
  std::optional<localization::FoundMounting> found;  ///< by a search, where nothing states it
  std::string refusal{};  ///< why a log with that mounting cannot be mapped; empty if it can
};

/// Takes the laser mounting from --laser, the configuration, the log or, where a recording does not
/// state it, from its scans. Reports the mounting, scans that contradict the log, and the chosen
/// topics of a recording on stderr. Completes `topics` by the facts on the mounting that a reader
/// of the log needs. Throws service::BadInputError when the log cannot be read.
MountingChoice choose_mounting(pipeline::LoadedConfig& config, const std::filesystem::path& log,
                               recording::TopicChoice& topics);

/// Sets the mounting in a configuration.
void set_mounting(pipeline::LoadedConfig& config, const geometry::Pose2& T_robot_laser);

/// The mounting by the scans and the odometry of a log; unknown without odometry. Throws
/// service::BadInputError when it cannot be read.
localization::FoundMounting search_mounting(const pipeline::Config& config,
                                            const std::filesystem::path& log,
                                            const recording::TopicChoice& topics);

}  // namespace topogeo::cli
