#include "common/log_mounting.hpp"

#include <cstdint>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/service/service_options.hpp"

#include "common/configuration.hpp"

namespace topogeo::cli {
namespace {

/// Mounting if nothing states it.
MountingChoice take_found(const localization::FoundMounting& found, pipeline::LoadedConfig& config,
                          recording::TopicChoice& topics) {
  std::cerr << "topogeo: " << pipeline::text_of(found) << '\n';
  set_mounting(config, found.T_robot_laser);
  topics.T_robot_laser = found.T_robot_laser;
  topics.upside_down |= found.upside_down;
  return {found.heading_known, found, {}};
}

/// Delay of the stamps of scans against those of odometry, if the motions of a recording show one.
std::optional<localization::ScanDelay> scan_delay(const recording::LogReader& reader,
                                                  const pipeline::DriveMotions& drive,
                                                  bool upside_down) {
  const auto turn_rad = [&reader](std::int64_t first_ns,
                                  std::int64_t last_ns) -> std::optional<double> {
    const auto first = reader.odometry_at(first_ns);
    const auto last = reader.odometry_at(last_ns);
    if (!first || !last || first->epoch != last->epoch) return std::nullopt;
    return geometry::wrap_angle(last->T_odom_robot.theta_rad - first->T_odom_robot.theta_rad);
  };
  return localization::find_scan_delay(drive.motions, turn_rad, upside_down);
}

struct SearchedMotions {
  pipeline::DriveMotions drive;
  localization::FoundMounting mounting;
};

/// The motions of a log and their mounting; none without odometry.
SearchedMotions searched(recording::LogReader& reader, const pipeline::Config& config) {
  if (!reader.has_odometry()) return {};
  SearchedMotions found;
  found.drive = pipeline::laser_motions([&reader] { return reader.next(); }, config);
  found.mounting = pipeline::find_mounting(found.drive);
  return found;
}

/// The same. A delay of the scans that no flag states is reported, and goes to `topics`.
SearchedMotions search_motions(const pipeline::Config& config, const std::filesystem::path& log,
                               recording::TopicChoice& topics) {
  recording::LogReader reader(log, config.log, topics);
  SearchedMotions found = searched(reader, config);
  if (!recording::is_recording(log) || topics.scan_delay_s) return found;
  const auto delay = scan_delay(reader, found.drive, found.mounting.upside_down);
  if (!delay) return found;
  std::cerr << "topogeo: " << pipeline::text_of(*delay) << '\n';
  topics.scan_delay_s = delay->delay_s;
  return search_motions(config, log, topics);
}

}  // namespace

void set_mounting(pipeline::LoadedConfig& config, const geometry::Pose2& T_robot_laser) {
  pipeline::mount_laser(config.config, T_robot_laser);
  config.effective = support::effective(pipeline::describe(config.config));
}

MountingChoice choose_mounting(pipeline::LoadedConfig& config, const std::filesystem::path& log,
                               recording::TopicChoice& topics) {
  if (topics.T_robot_laser) set_mounting(config, *topics.T_robot_laser);
  config.laser_set |= topics.T_robot_laser.has_value();
  try {
    const recording::LogMounting in_log = recording::mounting_in_log(log, topics);
    print_notes(in_log.notes);
    const std::string message = pipeline::choose_mounting(config, in_log.T_robot_laser);
    if (!message.empty()) std::cerr << "topogeo: " << message << '\n';
    const bool stated = config.laser_set || in_log.T_robot_laser.has_value();
    if (config.laser_set && !recording::is_recording(log)) return {true, std::nullopt, {}};
    const SearchedMotions searched = search_motions(config.config, log, topics);
    if (config.laser_set) return {true, std::nullopt, {}};
    const localization::FoundMounting& found = searched.mounting;
    std::string refusal = pipeline::changing(searched.drive, found);
    // A CARMEN log has the laser at its poses, if it states no other mounting.
    if (!stated && recording::is_recording(log)) {
      MountingChoice choice = take_found(found, config, topics);
      choice.refusal = std::move(refusal);
      return choice;
    }
    const geometry::Pose2& T_robot_laser = config.config.local_mapper.T_robot_laser;
    const std::string warning = pipeline::contradiction(found, T_robot_laser);
    if (refusal.empty()) refusal = pipeline::other_heading(found, T_robot_laser);
    if (refusal.empty() && !warning.empty()) std::cerr << "topogeo: " << warning << '\n';
    if (refusal.empty()) refusal = pipeline::mirroring(found);
    return {stated, std::nullopt, std::move(refusal)};
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

localization::FoundMounting search_mounting(const pipeline::Config& config,
                                            const std::filesystem::path& log,
                                            const recording::TopicChoice& topics) {
  try {
    recording::LogReader reader(log, config.log, topics);
    return searched(reader, config).mounting;
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

}  // namespace topogeo::cli
