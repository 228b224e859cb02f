// What files of records, some of them in compressed chunks, have in common: MCAP and the bags of
// ROS 1. They are read from front to back.
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
  /// Throws std::runtime_error with `expected` where the file cannot be read or starts otherwise.
  ChunkedSource(const std::filesystem::path& path, TopicFilter wanted,
                std::span<const std::byte> magic, std::string_view expected);

  /// Where the messages of a connection or channel go.
  struct Channel {
    std::size_t topic = 0;
    bool wanted = false;
  };
  Channel channel_of(const Topic& topic);

  /// The record of the file at at(), which moves on; true when it is a message to give out. Throws
  /// FormatError.
  virtual bool read_record(RawMessage& message) = 0;
  /// The same of the chunk that is open, where `cursor` stands, which is moved behind the record.
  virtual bool read_record_of_chunk(Cursor& cursor, RawMessage& message) = 0;

  [[nodiscard]] InputFile& file() { return file_; }
  [[nodiscard]] std::uint64_t at() const { return at_; }
  void move_to(std::uint64_t at) { at_ = at; }
  [[nodiscard]] UnpackBudget& budget() { return budget_; }
  void end() { ended_ = true; }
  /// An empty one, to be filled, whose records come next.
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
