// Writes MCAP in the form of rosbag2 (profile ros2): chunks with their indexes, a summary.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "byte_buffer.hpp"
#include "compression.hpp"
#include "mcap_format.hpp"
#include "message_sink.hpp"
#include "output_stream.hpp"

namespace topogeo::recording {

class McapSink final : public MessageSink {
 public:
  McapSink(const std::filesystem::path& path, Compression compression);
  [[nodiscard]] Encoding encoding() const override { return Encoding::kCdr; }
  void write(const OutputMessage& message) override;
  void close() override;

 private:
  using Entries =
      std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // stamp (ns), offset in the chunk
  struct Channel {
    std::uint16_t id = 0;
    std::uint64_t messages = 0;
  };

  Channel& channel_of(const OutputMessage& message);
  std::uint16_t schema_of(std::string_view type);
  void write_chunk();
  /// Returns the total length of the indexes, and fills in the offset of each.
  std::uint64_t write_message_indexes(ByteBuffer& offsets);
  void write_summary();

  OutputStream file_;
  Compression compression_;
  ByteBuffer chunk_;
  std::map<std::uint16_t, Entries> entries_;  // messages of the open chunk, by channel id
  std::map<std::string, Channel> channels_;
  std::map<std::string, std::uint16_t, std::less<>> schemas_;
  ByteBuffer schema_records_;
  ByteBuffer channel_records_;
  ByteBuffer chunk_indexes_;
  std::uint32_t chunks_ = 0;
  std::uint64_t messages_ = 0;
  std::uint64_t first_ns_ = 0;
  std::uint64_t last_ns_ = 0;
};

}  // namespace topogeo::recording
