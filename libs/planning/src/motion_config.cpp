#include "topogeo/planning/motion_config.hpp"

#include "topogeo/planning/detour_config.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::planning {

void describe(SmoothPathConfig& config, support::ConfigSchema& schema) {
  schema.add("navigator.min_radius_m", &config.min_radius_m, 0.01, 10.0, "m",
             "radius of the tightest arc; corners with less room are turned on the spot");
  schema.add("navigator.max_radius_m", &config.max_radius_m, 0.01, 100.0, "m",
             "largest radius of an arc; arcs are as wide as fits");
  schema.add("navigator.path_step_m", &config.step_m, 0.005, 10.0, "m",
             "distance between samples of the path");
  schema.fix({"navigator.path_step_m"});
}

void describe(DetourConfig& config, support::ConfigSchema& schema) {
  schema.add("navigator.detour_half_side_m", &config.half_side_m, 0.5, 20.0, "m",
             "half of the side of the window in which a path around an obstacle is searched");
  schema.add(
      "navigator.detour_snap_m", &config.start_snap_m, 0.0, 5.0, "m",
      "largest distance between a robot that stands near an obstacle and the start of its detour");
  schema.fix({"navigator.detour_half_side_m", "navigator.detour_snap_m"});
}

void check(const SmoothPathConfig& config) {
  support::check_ranges(config);
  support::require_at_least("navigator.max_radius_m", config.max_radius_m, "navigator.min_radius_m",
                            config.min_radius_m);
}

void check(const DetourConfig& config) {
  support::check_ranges(config);
}

}  // namespace topogeo::planning
