// Converts messages of ROS from and to bytes: CDR of ROS 2 and DDS, and the serialization of ROS 1,
// which has no alignment and a sequence number in each header. Lengths are checked before
// allocation, which the code of fastddsgen does not do; a test compares the bytes with its own.
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

/// Thrown for bytes that are not such a message: "byte 12: expected ..., got ...", counted from the
/// first one.
struct DecodeError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a whole message; bytes after it are ignored. Message: LaserScan, Odometry, TFMessage,
/// PoseStamped, PoseWithCovarianceStamped or TransformStamped, and in CDR also OccupancyGrid and
/// MarkerArray. Throws DecodeError.
template <typename Message>
Message decode(std::span<const std::byte> bytes, Encoding encoding);

/// Appends one of the same messages to `bytes`, CDR in little endian. Throws std::invalid_argument
/// for other encodings.
template <typename Message>
void encode(const Message& message, Encoding encoding, std::vector<std::byte>& bytes);

}  // namespace topogeo::recording
