// Writes bags of ROS 1, version 2.0, with their indexes.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "byte_buffer.hpp"
#include "compression.hpp"
#include "message_sink.hpp"
#include "output_stream.hpp"

namespace topogeo::recording {

class BagSink final : public MessageSink {
 public:
  BagSink(const std::filesystem::path& path, Compression compression);
  [[nodiscard]] Encoding encoding() const override { return Encoding::kRos1; }
  void write(const OutputMessage& message) override;
  void close() override;

 private:
  using Entries =
      std::vector<std::pair<std::uint64_t, std::uint32_t>>;  // time, offset in the chunk

  std::uint32_t connection_of(const OutputMessage& message);
  void write_header(std::uint64_t index_position);
  void write_chunk();

  OutputStream file_;
  Compression compression_;
  ByteBuffer chunk_;
  std::map<std::uint32_t, Entries> entries_;  // of the chunk, by connection
  std::uint64_t chunk_first_ = 0;             // times in bag format
  std::uint64_t chunk_last_ = 0;
  std::map<std::string, std::uint32_t> connections_;
  ByteBuffer connection_records_;
  ByteBuffer chunk_infos_;
  std::uint32_t chunks_ = 0;
};

}  // namespace topogeo::recording
