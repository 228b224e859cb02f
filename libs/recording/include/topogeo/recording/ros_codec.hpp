// Messages of ROS from and to bytes: CDR as ROS 2 and DDS write it, and the serialization of ROS 1,
// which has no alignment and a sequence number in each header. Lengths are checked before anything
// is allocated, which the code of fastddsgen does not do; that the bytes are the same as its own is
// a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace topogeo::recording {

enum class Encoding : std::uint8_t {
  kCdr,    ///< ROS 2: XCDR1 of either byte order, with its four bytes of encapsulation
  kRos1,   ///< ROS 1
  kOther,  ///< not read here
};

/// Thrown for bytes that are no such message: "byte 12: expected ..., got ...", counted from the
/// first one.
struct DecodeError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a whole message; bytes after it are ignored. Message: LaserScan, Odometry or TfMessage of
/// ros_types.hpp, and in CDR also OccupancyGrid, PoseWithCovarianceStamped and MarkerArray. Throws
/// DecodeError.
template <typename Message>
Message decode(std::span<const std::byte> bytes, Encoding encoding);

/// Appends a message to `bytes`, CDR in little endian. The same messages. Throws
/// std::invalid_argument for other encodings of these.
template <typename Message>
void encode(const Message& message, Encoding encoding, std::vector<std::byte>& bytes);

}  // namespace topogeo::recording
