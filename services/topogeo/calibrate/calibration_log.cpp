#include "calibrate/calibration_log.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

/// Largest number of accepted matches per stop: enough to get motions of one to six metres.
constexpr std::uint32_t kRecentMatches = 6;

}  // namespace

pipeline::LoadedConfig load_for_calibration(const std::optional<std::filesystem::path>& config,
                                            const std::optional<std::filesystem::path>& out,
                                            const std::filesystem::path& log,
                                            recording::TopicChoice& topics) {
  pipeline::LoadedConfig loaded = load(config);
  if (out) {
    const auto directory = std::filesystem::absolute(*out).parent_path();
    if (!std::filesystem::is_directory(directory)) {
      throw std::runtime_error(out->string() + ": its directory does not exist");
    }
    support::check_writable_directory(directory);
  }
  choose_mounting(loaded, log, topics);
  return loaded;
}

OpenLog open_log(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                 const recording::TopicChoice& topics) {
  try {
    recording::LogReader reader(path, options, topics);
    report_no_return(reader);
    const std::uint64_t scans = reader.scan_count();
    return {std::move(reader), scans};
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

Bar::Bar(const char* label, const char* unit)
    : bar_(std::cerr, support::stderr_is_terminal(), label, unit),
      start_s_(support::monotonic_s()) {}

void Bar::update(std::uint64_t done, std::uint64_t total) {
  bar_.update(done, total, support::monotonic_s() - start_s_);
  done_ = done;
}

void Bar::finish() {
  bar_.finish(done_, done_, support::monotonic_s() - start_s_);
}

localization::LocalMaps make_maps(const pipeline::Config& config, OpenLog& log) {
  std::vector<localization::LocalMaps> drives;
  const auto take = [&](std::optional<topomap::LocalMap> map) {
    if (!map) return;
    const bool begins = drives.empty() || drives.back().back()->stop.session != map->stop.session;
    if (begins) drives.emplace_back();
    drives.back().push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
  };
  Bar bar("following", "scans");
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  std::uint64_t done = 0;
  while (const std::optional<scan::Scan> scan = log.reader.next()) {
    take(mapper.add(*scan));
    bar.update(++done, log.laser_lines);
  }
  take(mapper.finish());
  bar.finish();
  if (drives.empty()) return {};
  if (drives.size() > 1) {
    std::cerr << fmt::format("the odometry breaks {} times: the longest part counts\n",
                             drives.size() - 1);
  }
  return std::move(*std::ranges::max_element(drives, {}, &localization::LocalMaps::size));
}

MatchedLog match_log(const pipeline::Config& config, OpenLog& log) {
  localization::LocalizerConfig matching = config.localizer;
  matching.recent_matches = std::max(matching.recent_matches, kRecentMatches);
  matching.revisit_matches = 0;
  matching.final_passes = 0;
  localization::InProcessPool searching;
  localization::RecordingPool pool(searching);
  localization::PoseGraphSlam slam(matching, pool);
  MatchedLog result;
  result.maps = make_maps(config, log);
  Bar bar("matching", "stops");
  std::uint64_t done = 0;
  for (const auto& map : result.maps) {
    slam.add(map);
    bar.update(++done, result.maps.size());
  }
  bar.finish();
  slam.finish();
  result.matched =
      localization::motions_from_matches(result.maps, pool.accepted(), slam.trajectory());
  return result;
}

std::string describe_drive(const localization::LocalMaps& maps) {
  double path_m = 0.0;
  double turn_rad = 0.0;
  for (const auto& stretch : localization::odometry_stretches(maps)) {
    for (const geometry::Pose2& step : stretch) {
      path_m += std::sqrt(step.position_m().squaredNorm());
      turn_rad += std::fabs(step.theta_rad);
    }
  }
  return fmt::format("{} stops, {:.1f} m of path, {:.1f} rad of turn", maps.size(), path_m,
                     turn_rad);
}

std::string describe_matches(const pipeline::Config& config,
                             const localization::MatchedMotions& matched) {
  return fmt::format(
      "{} matches of stops up to {:g} m apart; left out: {} that the others contradict, {} that "
      "the scans do not fix",
      matched.motions.size(), config.localizer.recent_way_m, matched.contradicted,
      matched.unrefined);
}

std::string configuration_with(const std::string& block, const std::string& comment,
                               const std::optional<std::filesystem::path>& config,
                               const geometry::Pose2& T_robot_laser) {
  if (!config) return "# " + comment + "\n" + block;
  pipeline::Config values;
  const support::ConfigSchema schema = pipeline::describe(values);
  support::load_yaml_file(*config, schema);
  values.local_mapper.T_robot_laser = T_robot_laser;  // the log's, if the file has none
  support::load_yaml_text(block, "the values found", schema);
  std::ostringstream whole;
  support::write_yaml(schema, whole);
  return whole.str();
}

}  // namespace topogeo::cli
