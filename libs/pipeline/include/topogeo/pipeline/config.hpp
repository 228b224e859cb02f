// All settings of the system: one YAML file for all services and for the single-process command.
#pragma once

#include <filesystem>
#include <optional>

#include "topogeo/calibration/odometry_calibration_config.hpp"
#include "topogeo/navigation/explorer_config.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/pipeline/hybrid_map_config.hpp"
#include "topogeo/pipeline/local_mapper_config.hpp"
#include "topogeo/pipeline/metrics_config.hpp"
#include "topogeo/pipeline/odometry_source.hpp"
#include "topogeo/pipeline/report_config.hpp"
#include "topogeo/planning/hybrid_planner_config.hpp"
#include "topogeo/planning/planning_config.hpp"
#include "topogeo/scan/carmen_log_config.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/support/config_schema.hpp"
#include "topogeo/topomap/global_map_config.hpp"

namespace topogeo::pipeline {

struct Config {
  scan::CarmenLogOptions log;
  OdometrySource odometry_source = OdometrySource::kAuto;
  LocalMapperConfig local_mapper;
  localization::LocalizerConfig localizer;
  topomap::GlobalMapConfig global_map;
  planning::PlanningConfig planning;
  planning::PlannerConfig planner;
  HybridMapConfig hybrid_map;
  planning::HybridPlannerConfig hybrid_planner;
  navigation::NavigatorConfig navigator;
  navigation::TourConfig exploration;
  localization::OdometryCalibrationConfig calibration;
  MetricsConfig metrics;
  ReportConfig report;
};

/// Every key of the file: the declarations of all libraries, one after the other.
support::ConfigSchema describe(Config& config);

/// The configuration of a file, or the defaults without one. Its `effective` goes into reports.
/// Throws std::runtime_error naming file, line and key, or file and field for inconsistent values.
struct LoadedConfig {
  Config config;
  support::EffectiveConfig effective;
  bool laser_set = false;           ///< the file sets at least one key of section `laser`
  bool stop_distance_set = false;   ///< ... stop.distance_m
  bool range_scale_set = false;     ///< ... scan.range_scale
  bool odometry_noise_set = false;  ///< ... at least one noise parameter of section `odometry`
};
LoadedConfig load_config(const std::optional<std::filesystem::path>& file);

/// Changes a value of a configuration after it was loaded, with all that follow from it.
void set_stop_distance(LoadedConfig& loaded, double distance_m);
void set_odometry_noise(LoadedConfig& loaded, const localization::OdometryNoise& noise);
void use_laser_odometry(LoadedConfig& loaded);

}  // namespace topogeo::pipeline
