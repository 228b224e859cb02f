// Participants for programs outside topogeo, such as nodes of ROS 2: in the default partition,
// without security whatever TOPOGEO_SECURITY says, by UDP. They are found by multicast, on their
// own host also without.
#pragma once

#include <string_view>

namespace topogeo::messaging {

/// ParticipantOptions::profile of such a participant; its partition does not count.
inline constexpr const char* kRosProfile = "ros";
/// The same for nodes that use the address 127.0.0.1 alone (Humble with ROS_LOCALHOST_ONLY=1).
inline constexpr const char* kRosLocalhostProfile = "ros_localhost";

inline bool is_ros_profile(std::string_view profile) {
  return profile == kRosProfile || profile == kRosLocalhostProfile;
}

}  // namespace topogeo::messaging
