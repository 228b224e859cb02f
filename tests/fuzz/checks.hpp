// Invariants for any input bytes: one function per format. The fuzzers call it with generated
// inputs, the tests with the committed seeds.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::fuzz {

/// Thrown by a check when the tested code violates a guarantee. Only main() may catch it.
struct BrokenPromise : std::logic_error {
  using std::logic_error::logic_error;
};

inline void require(bool holds, const char* promise) {
  if (!holds) throw BrokenPromise(promise);
}

/// Reads `bytes` as a CARMEN log, plain or gzip, and makes local maps of its first scans. Returns
/// their number; 0 when the reader rejects the log. Throws BrokenPromise when a scan or a map is
/// not well-formed, and passes on any exception of the libraries for a scan from their reader.
std::size_t check_carmen_log(std::string_view bytes);

/// Reads `bytes` as a ROS recording in the format of their first bytes, message by message and as a
/// log. Returns the number of whole messages; 0 when the reader rejects the file. Throws
/// BrokenPromise.
std::size_t check_recording(std::string_view bytes);

/// Reads `bytes` as a map file, as they are and again with a correct header and checksum, because
/// no random change keeps the checksum. A readable map must be equal after writing and reading.
/// Returns how many of the two were readable. Throws BrokenPromise.
std::size_t check_map_file(std::string_view bytes);

/// Passes `bytes` as received from a SICK laser through the decoder, split in several ways, and
/// through the driver. Returns the number of telegrams that the decoder found. Throws
/// BrokenPromise.
std::size_t check_sick_decoder(std::string_view bytes);

/// Passes `bytes` after the first, which chooses a row of laser_models(), as received from that
/// laser through its driver, at the rate of its line. Returns the number of scans. Throws
/// BrokenPromise.
std::size_t check_laser_driver(std::string_view bytes);

/// Passes `bytes` as received from a B21 base, in both dialects, through the decoder, split in
/// several ways, and through the driver. Returns the number of messages that the decoders found.
/// Throws BrokenPromise.
std::size_t check_mcp_decoder(std::string_view bytes);

/// Passes `bytes` as received from a microcontroller with the line protocol through the reader,
/// split in several ways, and through the driver. Returns the number of odometry reports that the
/// driver makes of them. Throws BrokenPromise.
std::size_t check_text_base(std::string_view bytes);

/// Passes `bytes` after the first, which chooses a base that counts the ticks of two wheels, as
/// received from it through its decoder, split in several ways, and through its driver. Returns the
/// number of odometry reports that the driver makes of them. Throws BrokenPromise.
std::size_t check_base_driver(std::string_view bytes);

/// Passes `bytes` as an RTPS packet, as a discovery payload and as a handshake payload through the
/// filters in front of the middleware's parser. An accepted input must contain what it states,
/// wherever the middleware follows it. Returns the submessages of an accepted packet plus one for
/// each accepted payload. Throws BrokenPromise.
std::size_t check_packet_parser(std::string_view bytes);

/// Passes `bytes`, the name of a topic, a line end and the payload of a sample, through a reader of
/// the topic: address filter, decoding, checks, conversion, and the handling in the services.
/// Returns 2 when they accept it, 1 when they refuse it with std::invalid_argument, which becomes a
/// fault of their status, 0 when the reader rejects it. Throws BrokenPromise.
std::size_t check_message(std::string_view bytes);

/// An input for check_message() of each topic that its readers accept.
std::vector<std::string> sample_messages();

/// Passes `bytes`, the type of a ROS message that the bridge reads ("LaserScan"), a line end and
/// the payload of a sample, through a reader of such a topic and through the bridge, with scans and
/// odometry before and after it. Our readers must accept the bridge's output, and a payload may
/// take no more memory than its length permits. Returns 2 when the bridge accepts the message, 1
/// when it refuses it, which becomes a drop of its status, 0 when the reader rejects it. Throws
/// BrokenPromise.
std::size_t check_ros_message(std::string_view bytes);

/// An input for check_ros_message() of each type that the bridge accepts.
std::vector<std::string> sample_ros_messages();

}  // namespace topogeo::fuzz
