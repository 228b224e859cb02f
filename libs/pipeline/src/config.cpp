#include "topogeo/pipeline/config.hpp"

#include <algorithm>
#include <stdexcept>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"

namespace topogeo::pipeline {
namespace {

// With an outline the centre keeps the inscribed radius from obstacles; the planner of outlines
// checks the rest of the body.
void size_by_outline(Config& c) {
  const geometry::Footprint& body = c.navigator.guard.footprint;
  if (body.empty()) return;
  const double centre_m = geometry::inscribed_radius_m(body);
  c.hybrid_map.inflation.forbidden_cells = centre_m / c.hybrid_map.grid.resolution_m;
  c.planning.min_clearance_m = centre_m + c.navigator.guard.side_margin_m;
}

// Copies keys that stand for several variables.
void share_values(Config& c) {
  mount_laser(c, c.local_mapper.T_robot_laser);
  c.local_mapper.tracker.odometry = c.localizer.odometry;
  c.navigator.voronoi = c.local_mapper.voronoi;
  c.navigator.local_map = c.local_mapper.local_map;
  size_by_outline(c);
  c.calibration.fallback = c.localizer.odometry;
  c.calibration.seed = c.localizer.seed;
}

// Notes which parts the file sets. A key that is missing in the file keeps its earlier value, so
// two configurations that differed before then still differ.
void note_set_keys(const std::filesystem::path& file, LoadedConfig& loaded) {
  Config other;
  other.local_mapper.T_robot_laser = {1.0, 1.0, 1.0};
  other.local_mapper.stop_distance_m *= 2.0;
  other.log.range_scale = 0.5;
  localization::OdometryNoise& noise = other.localizer.odometry;
  for (const localization::NoiseParameter& parameter : localization::kOdometryParameters) {
    noise.*parameter.field *= 0.5;
  }
  support::load_yaml_file(file, describe(other));
  const Config& read = loaded.config;
  const geometry::Pose2& laser = read.local_mapper.T_robot_laser;
  const geometry::Pose2& other_laser = other.local_mapper.T_robot_laser;
  loaded.laser_set = laser.x_m == other_laser.x_m || laser.y_m == other_laser.y_m ||
                     laser.theta_rad == other_laser.theta_rad;
  loaded.stop_distance_set =
      read.local_mapper.stop_distance_m == other.local_mapper.stop_distance_m;
  loaded.range_scale_set = read.log.range_scale == other.log.range_scale;
  loaded.odometry_noise_set =
      std::ranges::any_of(localization::kOdometryParameters, [&](const auto& parameter) {
        return read.localizer.odometry.*parameter.field == noise.*parameter.field;
      });
}

// Checks relations between values beyond the ranges of the keys.
void check_values(const Config& c) {
  scan::check(c.log);
  voronoi::check(c.local_mapper.voronoi);
  topomap::check(c.local_mapper.local_map);
  topomap::check(c.global_map);
  planning::check(c.planning);
  localization::check(c.localizer);
  check(c.hybrid_map);
  planning::check(c.hybrid_planner);
  navigation::check(c.navigator);
  navigation::check(c.exploration);
}

}  // namespace

void set_stop_distance(LoadedConfig& loaded, double distance_m) {
  loaded.config.local_mapper.stop_distance_m = distance_m;
  loaded.effective = support::effective(describe(loaded.config));
}

void set_odometry_noise(LoadedConfig& loaded, const localization::OdometryNoise& noise) {
  loaded.config.localizer.odometry = noise;
  share_values(loaded.config);
  loaded.effective = support::effective(describe(loaded.config));
}

void use_laser_odometry(LoadedConfig& loaded) {
  loaded.config.odometry_source = OdometrySource::kLaser;
  loaded.effective = support::effective(describe(loaded.config));
}

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
    note_set_keys(*file, loaded);
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
