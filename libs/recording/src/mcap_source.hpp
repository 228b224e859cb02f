// Reads MCAP (https://mcap.dev/spec) from front to back, skipping chunks in which the index at its
// end lists no wanted channel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "chunked_source.hpp"
#include "mcap_index.hpp"

namespace topogeo::recording {

class McapSource final : public ChunkedSource {
 public:
  /// Throws std::runtime_error.
  McapSource(const std::filesystem::path& path, TopicFilter wanted);

 private:
  void take_summary(const McapSummary& summary);
  bool read_record(RawMessage& message) override;
  bool read_record_of_chunk(Cursor& cursor, RawMessage& message) override;
  bool take_message(std::span<const std::byte> content, RawMessage& message);
  void take_schema(std::span<const std::byte> content);
  void take_channel(std::span<const std::byte> content);
  void open_chunk(std::span<const std::byte> content);

  std::map<std::uint16_t, std::string> schemas_;  // names
  std::map<std::uint16_t, Channel> channels_;
  std::vector<std::byte> unpacked_message_;
  std::map<std::uint64_t, std::uint64_t> unwanted_chunks_;  // start of each and of the next record
};

}  // namespace topogeo::recording
