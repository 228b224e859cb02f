// What recordings store of the types of messages: names, definitions, checksums.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace topogeo::recording {

struct RosDefinition {
  std::string_view type;    ///< "sensor_msgs/msg/LaserScan"
  std::string_view fields;  ///< the .msg of ROS 2, without comments
  std::string_view
      ros1_md5;  ///< of the definition in ROS 1; empty where it is not exchanged with ROS 1
  std::string_view
      type_hash;  ///< REP 2011, of ROS 2 from Iron on; empty where it is not written by itself
};

/// Null for types that are not known here.
const RosDefinition* find_definition(std::string_view type);

/// The definition with those that it consists of, as MCAP (schema encoding ros2msg) and rosbag2
/// store it. Throws std::invalid_argument for types that are not known here.
std::string ros2_definition_text(std::string_view type);

/// The same as ROS 1 stores it in bags.
std::string ros1_definition_text(std::string_view type);

/// "sensor_msgs/LaserScan".
std::string ros1_type_name(std::string_view type);

}  // namespace topogeo::recording
