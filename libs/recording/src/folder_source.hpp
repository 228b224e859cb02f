// Reads a folder of rosbag2: metadata.yaml names its files, which are read one after the other.
// If a killed recorder left no metadata.yaml, the files of the recording are read in the order of
// their numbers.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/recording/message_source.hpp"

namespace topogeo::recording {

class FolderSource final : public MessageSource {
 public:
  /// Throws std::runtime_error.
  FolderSource(const std::filesystem::path& folder, TopicFilter wanted);

  bool next(RawMessage& message) override;
  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::string position() const override;
  [[nodiscard]] const std::string& damage() const override { return damage_; }
  [[nodiscard]] double fraction_read() const override;

 private:
  void open_next();

  TopicFilter wanted_;
  std::vector<std::filesystem::path> files_;
  std::size_t opened_ = 0;
  std::unique_ptr<MessageSource> current_;
  std::vector<std::size_t> topic_of_current_;
  std::vector<Topic> topics_;
  std::string damage_;
};

}  // namespace topogeo::recording
