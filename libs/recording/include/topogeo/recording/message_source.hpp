// The messages of a recording, one after the other, whatever file they are in: rosbag2's SQLite
// (.db3), MCAP, the bag of ROS 1 (version 2.0), or a folder of rosbag2 with several of them. Files
// are read from front to back, a part at a time. An index (of MCAP) is used to pass over what is
// not wanted, but not needed, so that a recording that was cut off gives what it holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/recording/ros_codec.hpp"

namespace topogeo::recording {

struct Topic {
  std::string name;  ///< "/scan"
  std::string type;  ///< as ROS 2 has it: "sensor_msgs/msg/LaserScan"
  Encoding encoding = Encoding::kOther;

  friend bool operator==(const Topic&, const Topic&) = default;
};

struct RawMessage {
  std::size_t topic = 0;            ///< index in MessageSource::topics()
  std::int64_t log_time_ns = 0;     ///< when it was recorded
  std::span<const std::byte> data;  ///< valid until the next message is read
};

/// Which topics are read; others are passed over, and their messages are not looked at.
using TopicFilter = std::function<bool(const Topic&)>;

class MessageSource {
 public:
  virtual ~MessageSource() = default;
  MessageSource() = default;
  MessageSource(const MessageSource&) = delete;
  MessageSource& operator=(const MessageSource&) = delete;

  /// The next message of a topic that is read; false at the end, of what is whole.
  virtual bool next(RawMessage& message) = 0;

  /// All topics that have been met so far, read or not. Never shrinks.
  [[nodiscard]] virtual const std::vector<Topic>& topics() const = 0;

  /// Where the last message stands: "byte 1234", "message 12"; after the end: where that is.
  [[nodiscard]] virtual std::string position() const = 0;

  /// Why the recording ended before its end, with the position; empty where it did not.
  [[nodiscard]] virtual const std::string& damage() const = 0;

  /// Share of the files read so far, in [0, 1].
  [[nodiscard]] virtual double fraction_read() const = 0;
};

/// Whether a file or folder is to be read as a recording of ROS, by its first bytes or, where these
/// are those of no known file, by its name.
bool is_recording(const std::filesystem::path& path);

/// Throws std::runtime_error naming file, position and what was expected when it cannot be opened
/// or is no recording.
std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, TopicFilter wanted);

/// "sensor_msgs/msg/LaserScan" also for "sensor_msgs/LaserScan" of ROS 1 and for "tf/tfMessage",
/// which has become "tf2_msgs/msg/TFMessage".
std::string ros2_type_name(std::string_view type);

inline constexpr std::string_view kLaserScanType = "sensor_msgs/msg/LaserScan";
inline constexpr std::string_view kOdometryType = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kTfType = "tf2_msgs/msg/TFMessage";

}  // namespace topogeo::recording
