#include "topogeo/voronoi/voronoi_config.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace topogeo::voronoi {
namespace {

void check(const char* field, double value, double low, double high) {
  if (std::isfinite(value) && value >= low && value <= high) return;
  throw std::invalid_argument(std::string("VoronoiConfig.") + field + " is " +
                              std::to_string(value) + ", must be in [" + std::to_string(low) +
                              ", " + std::to_string(high) + "]");
}

}  // namespace

void validate(const VoronoiConfig& config) {
  check("range_limit_m", config.range_limit_m, 0.5, 100.0);
  check("resolution_m", config.resolution_m, 0.01, 1.0);
  // Tables of all cells: beyond 16 million cells they take hundreds of megabytes.
  check("range_limit_m / resolution_m", config.range_limit_m / config.resolution_m, 2.0, 2000.0);
  check("forward_rad", config.forward_rad, -6.3, 6.3);
  check("dropout_rad", config.dropout_rad, 0.0, 0.5);
  check("discontinuity_m", config.discontinuity_m, 0.0, 100.0);
  check("on_wall_m", config.on_wall_m, 0.0, 1.0);
  check("contiguous_m", config.contiguous_m, 0.0, 100.0);
  check("alternate_m", config.alternate_m, 0.0, 100.0);
  check("min_group_points", config.min_group_points, 0, 10000);
  check("site_spacing_m", config.site_spacing_m, 0.0, 10.0);
  check("node_merge_m", config.node_merge_m, 0.0, 10.0);
  check("min_branch_m", config.min_branch_m, 0.0, 10.0);
  check("virtual_half_width_m", config.virtual_half_width_m, 0.05, 10.0);
}

}  // namespace topogeo::voronoi
