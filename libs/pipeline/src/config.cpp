#include "topogeo/pipeline/config.hpp"

#include <stdexcept>

#include "topogeo/pipeline/laser_mounting.hpp"

namespace topogeo::pipeline {
namespace {

// Copies keys that stand for several variables.
void share_values(Config& c) {
  mount_laser(c, c.local_mapper.T_robot_laser);
  c.local_mapper.tracker.odometry = c.localizer.odometry;
  c.navigator.voronoi = c.local_mapper.voronoi;
  c.navigator.local_map = c.local_mapper.local_map;
  c.calibration.fallback = c.localizer.odometry;
  c.calibration.seed = c.localizer.seed;
}

// A key that is missing in the file keeps its earlier value, so the result then differs.
bool sets_laser(const std::filesystem::path& file, const geometry::Pose2& read) {
  Config other;
  other.local_mapper.T_robot_laser = {1.0, 1.0, 1.0};
  support::load_yaml_file(file, describe(other));
  const geometry::Pose2& read_again = other.local_mapper.T_robot_laser;
  return read.x_m == read_again.x_m || read.y_m == read_again.y_m ||
         read.theta_rad == read_again.theta_rad;
}

// Checks relations between values beyond the ranges of the keys.
void check_values(const Config& c) {
  scan::check(c.log);
  voronoi::check(c.local_mapper.voronoi);
  topomap::check(c.local_mapper.local_map);
  topomap::check(c.global_map);
  planning::check(c.planning);
  check(c.hybrid_map);
  planning::check(c.hybrid_planner);
  navigation::check(c.navigator);
  navigation::check(c.exploration);
}

}  // namespace

support::ConfigSchema describe(Config& config) {
  support::ConfigSchema schema;
  scan::describe(config.log, schema);
  describe(config.local_mapper, schema);
  voronoi::describe(config.local_mapper.voronoi, schema);
  topomap::describe(config.local_mapper.local_map, schema);
  localization::describe(config.local_mapper.tracker, schema);
  describe(config.odometry_source, schema);
  localization::describe(config.localizer, schema);
  topomap::describe(config.global_map, schema);
  planning::describe(config.planner, schema);
  planning::describe(config.planning, schema);
  planning::describe(config.hybrid_map.grid, schema);
  planning::describe(config.hybrid_map.inflation, schema);
  planning::describe(config.hybrid_map.zones, schema);
  planning::describe(config.hybrid_planner, schema);
  navigation::describe(config.navigator, schema);
  planning::describe(config.navigator.smooth, schema);
  planning::describe(config.navigator.detour, schema);
  markov::describe(config.navigator.markov.markov, schema);
  markov::describe(config.navigator.markov.poses, schema);
  navigation::describe(config.exploration, schema);
  localization::describe(config.calibration, schema);
  describe(config.metrics, schema);
  describe(config.report, schema);
  return schema;
}

LoadedConfig load_config(const std::optional<std::filesystem::path>& file) {
  LoadedConfig loaded;
  const support::ConfigSchema schema = describe(loaded.config);
  if (file) {
    support::load_yaml_file(*file, schema);
    loaded.laser_set = sets_laser(*file, loaded.config.local_mapper.T_robot_laser);
  }
  loaded.effective = support::effective(schema);
  share_values(loaded.config);
  try {
    check_values(loaded.config);
  } catch (const std::invalid_argument& error) {
    if (!file) throw;
    throw std::runtime_error(file->string() + ": " + error.what());
  }
  return loaded;
}

}  // namespace topogeo::pipeline
