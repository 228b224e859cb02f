#include "topogeo/pipeline/config.hpp"

#include <stdexcept>

namespace topogeo::pipeline {
namespace {

// Where one key stands for several variables.
void share_values(Config& c) {
  c.local_mapper.voronoi.forward_rad = -c.local_mapper.T_robot_laser.theta_rad;
  c.local_mapper.tracker.odometry = c.localizer.odometry;
  c.calibration.fallback = c.localizer.odometry;
  c.calibration.seed = c.localizer.seed;
}

// Values that must fit each other, which the ranges of the keys do not state.
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
  localization::describe(config.localizer, schema);
  topomap::describe(config.global_map, schema);
  planning::describe(config.planning, schema);
  planning::describe(config.hybrid_map.grid, schema);
  planning::describe(config.hybrid_map.inflation, schema);
  planning::describe(config.hybrid_map.zones, schema);
  planning::describe(config.hybrid_planner, schema);
  navigation::describe(config.navigator, schema);
  planning::describe(config.navigator.smooth, schema);
  planning::describe(config.navigator.detour, schema);
  markov::describe(config.navigator.markov.markov, schema);
  navigation::describe(config.exploration, schema);
  localization::describe(config.calibration, schema);
  return schema;
}

LoadedConfig load_config(const std::optional<std::filesystem::path>& file) {
  LoadedConfig loaded;
  const support::ConfigSchema schema = describe(loaded.config);
  if (file) support::load_yaml_file(*file, schema);
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
