// Reads the messages of a recording in order, from any kind of file: rosbag2's SQLite (.db3), MCAP,
// the bag of ROS 1 (version 2.0), or a folder of rosbag2 with several of them. Files are read from
// front to back, part by part. An index (of MCAP) helps to skip unwanted parts but is not required,
// so a truncated recording is read as far as it goes.
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
  std::string type;  ///< in the notation of ROS 2: "sensor_msgs/msg/LaserScan"
  Encoding encoding = Encoding::kOther;

  friend bool operator==(const Topic&, const Topic&) = default;
};

struct RawMessage {
  std::size_t topic = 0;            ///< index in MessageSource::topics()
  std::int64_t log_time_ns = 0;     ///< time of recording
  std::span<const std::byte> data;  ///< valid until the next message is read
};

/// Selects the topics to read; messages of other topics are skipped unread.
using TopicFilter = std::function<bool(const Topic&)>;

class MessageSource {
 public:
  virtual ~MessageSource() = default;
  MessageSource() = default;
  MessageSource(const MessageSource&) = delete;
  MessageSource& operator=(const MessageSource&) = delete;

  /// The next message of a selected topic; false at the end of the readable part.
  virtual bool next(RawMessage& message) = 0;

  /// All topics met so far, read or not. Never shrinks.
  [[nodiscard]] virtual const std::vector<Topic>& topics() const = 0;

  /// Position of the last message: "byte 1234", "message 12"; after the end: of the end.
  [[nodiscard]] virtual std::string position() const = 0;

  /// Why the recording ended early, with the position; empty if it did not.
  [[nodiscard]] virtual const std::string& damage() const = 0;

  /// Share of the files read so far, in [0, 1].
  [[nodiscard]] virtual double fraction_read() const = 0;
};

/// Whether a file or folder should be read as a recording of ROS, by its first bytes or, if these
/// are unknown, by its name.
bool is_recording(const std::filesystem::path& path);

/// Throws std::runtime_error naming file, position and expectation if it cannot be opened or is not
/// a recording.
std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path, TopicFilter wanted);

/// "sensor_msgs/msg/LaserScan" also for "sensor_msgs/LaserScan" of ROS 1 and for "tf/tfMessage",
/// the former name of "tf2_msgs/msg/TFMessage".
std::string ros2_type_name(std::string_view type);

inline constexpr std::string_view kLaserScanType = "sensor_msgs/msg/LaserScan";
inline constexpr std::string_view kOdometryType = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kTfType = "tf2_msgs/msg/TFMessage";

}  // namespace topogeo::recording
