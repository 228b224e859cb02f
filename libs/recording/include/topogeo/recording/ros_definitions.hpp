// Data that recordings store about message types: names, definitions, checksums.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace topogeo::recording {

struct RosDefinition {
  std::string_view type;      ///< "sensor_msgs/msg/LaserScan"
  std::string_view fields;    ///< the .msg of ROS 2, without comments
  std::string_view ros1_md5;  ///< of the definition in ROS 1; empty if not exchanged with ROS 1
  std::string_view
      type_hash;  ///< REP 2011, of ROS 2 from Iron on; empty if never written on its own
};

/// Null for unknown types.
const RosDefinition* find_definition(std::string_view type);

/// The definition and those of its parts, in the format of MCAP (schema encoding ros2msg) and
/// rosbag2. Throws std::invalid_argument for unknown types.
std::string ros2_definition_text(std::string_view type);

/// The same in the format of ROS 1 bags.
std::string ros1_definition_text(std::string_view type);

/// "sensor_msgs/LaserScan".
std::string ros1_type_name(std::string_view type);

}  // namespace topogeo::recording
