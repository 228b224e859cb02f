// Common base for files of records with compressed chunks: MCAP and the bags of ROS 1. They are
// read from front to back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/recording/message_source.hpp"

#include "compression.hpp"
#include "input_file.hpp"

namespace topogeo::recording {

class ChunkedSource : public MessageSource {
 public:
  bool next(RawMessage& message) final;
  [[nodiscard]] const std::vector<Topic>& topics() const final { return topics_; }
  [[nodiscard]] std::string position() const final;
  [[nodiscard]] const std::string& damage() const final { return damage_; }
  [[nodiscard]] double fraction_read() const final;

 protected:
  /// Throws std::runtime_error with `expected` if the file cannot be read or has another start.
  ChunkedSource(const std::filesystem::path& path, TopicFilter wanted,
                std::span<const std::byte> magic, std::string_view expected);

  /// Destination of the messages of a connection or channel.
  struct Channel {
    std::size_t topic = 0;
    bool wanted = false;
  };
  Channel channel_of(const Topic& topic);

  /// Reads the record of the file at at(), which advances; true if it is a wanted message. Throws
  /// FormatError.
  virtual bool read_record(RawMessage& message) = 0;
  /// The same within the open chunk, at `cursor`, which advances.
  virtual bool read_record_of_chunk(Cursor& cursor, RawMessage& message) = 0;

  [[nodiscard]] InputFile& file() { return file_; }
  [[nodiscard]] std::uint64_t at() const { return at_; }
  void move_to(std::uint64_t at) { at_ = at; }
  [[nodiscard]] UnpackBudget& budget() { return budget_; }
  void end() { ended_ = true; }
  /// An empty chunk to be filled; its records come next.
  std::vector<std::byte>& begin_chunk();

 private:
  InputFile file_;
  UnpackBudget budget_;
  TopicFilter wanted_;
  std::uint64_t at_;          // of the next record in the file
  std::uint64_t record_ = 0;  // of the last one
  bool ended_ = false;
  std::vector<std::byte> chunk_;
  std::size_t chunk_at_ = 0;
  std::vector<Topic> topics_;
  std::string damage_;
};

}  // namespace topogeo::recording
