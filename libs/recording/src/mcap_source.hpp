// Reads MCAP (https://mcap.dev/spec) from front to back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/recording/message_source.hpp"

#include "input_file.hpp"

namespace topogeo::recording {

class McapSource final : public MessageSource {
 public:
  /// Throws std::runtime_error.
  McapSource(const std::filesystem::path& path, TopicFilter wanted);

  bool next(RawMessage& message) override;
  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::string position() const override;
  [[nodiscard]] const std::string& damage() const override { return damage_; }
  [[nodiscard]] double fraction_read() const override;

 private:
  struct Channel {
    std::size_t topic = 0;
    bool wanted = false;
  };

  /// The record at `at_`, which moves on; true when it is a message to give out.
  bool read_record(RawMessage& message);
  bool read_record_of_chunk(RawMessage& message);
  bool take_message(std::span<const std::byte> content, RawMessage& message);
  /// Its content is needed up to the data of the message only, where that is not wanted.
  void take_schema(std::span<const std::byte> content);
  void take_channel(std::span<const std::byte> content);
  void open_chunk(std::span<const std::byte> content);

  InputFile file_;
  TopicFilter wanted_;
  std::uint64_t at_ = 0;      // of the next record in the file
  std::uint64_t record_ = 0;  // of the last one
  bool ended_ = false;
  std::vector<std::byte> chunk_;
  std::size_t chunk_at_ = 0;
  std::map<std::uint16_t, std::string> schemas_;  // names
  std::map<std::uint16_t, Channel> channels_;
  std::vector<Topic> topics_;
  std::string damage_;
};

}  // namespace topogeo::recording
