// Participants that other programs than ours see, nodes of ROS 2: in the default partition, without
// security whatever TOPOGEO_SECURITY says, by UDP, found by multicast and on the own host without.
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
