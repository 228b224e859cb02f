// Records of a bag of ROS 1 that this library reads and writes.
#pragma once

#include <cstdint>
#include <string_view>

namespace topogeo::recording::bag {

inline constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
inline constexpr std::uint8_t kMessage = 0x02;
inline constexpr std::uint8_t kFileHeader = 0x03;
inline constexpr std::uint8_t kIndex = 0x04;
inline constexpr std::uint8_t kChunk = 0x05;
inline constexpr std::uint8_t kChunkInfo = 0x06;
inline constexpr std::uint8_t kConnection = 0x07;

}  // namespace topogeo::recording::bag
