// What must hold of whatever bytes stand in a file: one function per file format. The fuzzers call
// it with inputs of their own making, the tests with the committed seeds.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::fuzz {

/// Thrown by a check when the code under it broke a promise. Nothing but main() catches it.
struct BrokenPromise : std::logic_error {
  using std::logic_error::logic_error;
};

inline void require(bool holds, const char* promise) {
  if (!holds) throw BrokenPromise(promise);
}

/// Reads `bytes` as a CARMEN log, plain or gzip, and makes a local map of its first scans. Returns
/// how many it made; 0 when the reader refuses the log. Throws BrokenPromise when a scan or a map
/// is not well-formed, and lets through whatever else the libraries throw at a scan from their
/// reader.
std::size_t check_carmen_log(std::string_view bytes);

/// Reads `bytes` as a recording of ROS of the format that its first bytes name, message by message
/// and as a log. Returns how many messages were read whole; 0 when the reader refuses the file.
/// Throws BrokenPromise.
std::size_t check_recording(std::string_view bytes);

/// Reads `bytes` as a map file, as they are and once more with a start and a checksum that are
/// right, since no chance change of a file keeps its checksum. What can be read must be the same
/// after writing and reading. Returns how many of the two were read. Throws BrokenPromise.
std::size_t check_map_file(std::string_view bytes);

/// Takes `bytes` as what came over the line of a SICK laser, through the decoder, cut in several
/// ways, and through the driver. Returns how many telegrams the decoder found. Throws
/// BrokenPromise.
std::size_t check_sick_decoder(std::string_view bytes);

/// Takes `bytes` as what came over the line of a B21 base, in both dialects, through the decoder,
/// cut in several ways, and through the driver. Returns how many messages the decoders found.
/// Throws BrokenPromise.
std::size_t check_mcp_decoder(std::string_view bytes);

/// Takes `bytes` as a packet of RTPS, as a payload of discovery and as one of a handshake, through
/// what stands before the parser of the middleware. What passes must hold what it states, wherever
/// the middleware follows it. Returns the submessages of a packet that passes, and one for each of
/// the three that does. Throws BrokenPromise.
std::size_t check_packet_parser(std::string_view bytes);

/// Takes `bytes` as the name of a topic, a line end and the payload of a sample, through what a
/// reader of the topic does: the address filter, the decoding, the checks, the conversion, and what
/// the services make of it. Returns 2 when they take it, 1 when they refuse it with
/// std::invalid_argument, which becomes a fault of their status, 0 when the reader refuses it.
/// Throws BrokenPromise.
std::size_t check_message(std::string_view bytes);

/// An input for check_message() of each topic, which its readers take.
std::vector<std::string> sample_messages();

/// Takes `bytes` as the type of a message of ROS that the bridge reads ("LaserScan"), a line end
/// and the payload of a sample, through what a reader of such a topic does and through what the
/// bridge makes of the message, with scans and odometry before and after it. What it sends on is
/// what our readers take, and a payload takes no more memory than its length allows. Returns 2 when
/// the bridge takes the message, 1 when it refuses it, which becomes a drop of its status, 0 when
/// the reader refuses it. Throws BrokenPromise.
std::size_t check_ros_message(std::string_view bytes);

/// An input for check_ros_message() of each type, which the bridge takes.
std::vector<std::string> sample_ros_messages();

}  // namespace topogeo::fuzz
