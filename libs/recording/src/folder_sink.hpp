// Writes a folder of rosbag2: NAME/NAME_0.db3 with its metadata.yaml, which `ros2 bag` needs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "message_sink.hpp"
#include "sqlite_sink.hpp"

namespace topogeo::recording {

class FolderSink final : public MessageSink {
 public:
  /// Makes the folder. Throws std::runtime_error, also if it exists and is not empty.
  explicit FolderSink(const std::filesystem::path& folder);
  [[nodiscard]] Encoding encoding() const override { return messages_.encoding(); }
  void write(const OutputMessage& message) override;
  void close() override;

 private:
  struct Topic {
    std::string type;
    std::uint64_t messages = 0;
  };

  std::filesystem::path folder_;
  std::string file_;  // in the folder
  SqliteSink messages_;
  std::map<std::string, Topic> topics_;
  std::uint64_t count_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace topogeo::recording
