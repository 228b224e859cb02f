// Writes messages to the files of a recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "topogeo/recording/ros_codec.hpp"

namespace topogeo::recording {

struct OutputMessage {
  std::string topic;
  std::string_view type;  ///< one of ros_definitions.hpp
  std::int64_t time_ns = 0;
  std::span<const std::byte> data;  ///< in the encoding of the file
};

class MessageSink {
 public:
  virtual ~MessageSink() = default;
  MessageSink() = default;
  MessageSink(const MessageSink&) = delete;
  MessageSink& operator=(const MessageSink&) = delete;

  [[nodiscard]] virtual Encoding encoding() const = 0;
  /// Throws std::runtime_error when writing fails.
  virtual void write(const OutputMessage& message) = 0;
  /// Writes the data that readers expect at the end. Throws likewise.
  virtual void close() = 0;
};

/// Whether create_sink() supports a file with that name.
bool is_recording_name(const std::filesystem::path& path);

/// Selects the format by the ending of the name: .mcap, .db3, .bag; a folder of rosbag2 without an
/// ending or with a trailing slash; null for others. `compression`: see ConvertOptions. Throws
/// std::runtime_error if the file cannot be created, std::invalid_argument for a compression that
/// the format lacks.
std::unique_ptr<MessageSink> create_sink(const std::filesystem::path& path,
                                         const std::string& compression);

/// Whether late readers get the last message of a topic: /tf_static, /map and others that are
/// stated once.
bool is_latched(std::string_view topic);

/// Quality of service in rosbag2's form, complete, in numbers that all its versions read.
std::string qos_profile_text(bool latched);

}  // namespace topogeo::recording
