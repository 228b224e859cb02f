// The names of all services of the project.
#pragma once

#include <array>
#include <string_view>

namespace topogeo::service {

/// In the order of the ports of their metrics (metrics_address()).
inline constexpr auto kServiceNames = std::to_array<std::string_view>(
    {"sensor_gateway", "local_mapper", "localizer", "map_store", "planner", "navigator",
     "simulator", "ga_worker", "ros_bridge", "web"});

}  // namespace topogeo::service
