#include "mcap_sink.hpp"

#include <algorithm>
#include <limits>

#include <zlib.h>

#include "topogeo/recording/ros_definitions.hpp"

namespace topogeo::recording {
namespace {

using mcap::Opcode;

constexpr std::size_t kChunkSize = std::size_t{1} << 20U;

void append_record(ByteBuffer& out, Opcode opcode, const ByteBuffer& content) {
  out.number(static_cast<std::uint8_t>(opcode))
      .number(static_cast<std::uint64_t>(content.size()))
      .raw(content.bytes());
}

std::uint32_t crc_of(std::uint32_t start, std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(start, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string_view name_of(Compression compression) {
  if (compression == Compression::kZstd) return "zstd";
  return compression == Compression::kLz4 ? "lz4" : "";
}

}  // namespace

McapSink::McapSink(const std::filesystem::path& path, Compression compression)
    : file_(path), compression_(compression) {
  ByteBuffer out;
  out.raw(std::as_bytes(std::span(mcap::kMagic)));
  append_record(out, Opcode::kHeader, ByteBuffer().text("ros2").text("topogeo"));
  file_.write(out.bytes());
}

std::uint16_t McapSink::schema_of(std::string_view type) {
  const auto known = schemas_.find(type);
  if (known != schemas_.end()) return known->second;
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.emplace(type, id);
  const ByteBuffer content =
      ByteBuffer().number(id).text(type).text("ros2msg").text(ros2_definition_text(type));
  append_record(chunk_, Opcode::kSchema, content);
  append_record(schema_records_, Opcode::kSchema, content);
  return id;
}

McapSink::Channel& McapSink::channel_of(const OutputMessage& message) {
  const auto known = channels_.find(message.topic);
  if (known != channels_.end()) return known->second;
  const std::uint16_t schema = schema_of(message.type);
  const auto id = static_cast<std::uint16_t>(channels_.size());
  ByteBuffer metadata;
  metadata.text("offered_qos_profiles").text(qos_profile_text(is_latched(message.topic)));
  const RosDefinition* definition = find_definition(message.type);
  if (definition != nullptr && !definition->type_hash.empty()) {
    metadata.text("topic_type_hash").text("RIHS01_" + std::string(definition->type_hash));
  }
  const ByteBuffer content =
      ByteBuffer().number(id).number(schema).text(message.topic).text("cdr").counted(metadata);
  append_record(chunk_, Opcode::kChannel, content);
  append_record(channel_records_, Opcode::kChannel, content);
  return channels_.emplace(message.topic, Channel{id, 0}).first->second;
}

void McapSink::write(const OutputMessage& message) {
  Channel& channel = channel_of(message);
  const auto time_ns = static_cast<std::uint64_t>(message.time_ns);
  entries_[channel.id].emplace_back(time_ns, chunk_.size());
  constexpr std::uint64_t kMessageHead = 2 + 4 + 8 + 8;
  chunk_.number(static_cast<std::uint8_t>(Opcode::kMessage))
      .number(kMessageHead + static_cast<std::uint64_t>(message.data.size()))
      .number(channel.id)
      .number(static_cast<std::uint32_t>(channel.messages++))
      .number(time_ns)
      .number(time_ns)
      .raw(message.data);
  first_ns_ = messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  ++messages_;
  if (chunk_.size() >= kChunkSize) write_chunk();
}

std::uint64_t McapSink::write_message_indexes(ByteBuffer& offsets) {
  const std::uint64_t start = file_.at();
  for (auto& [channel, entries] : entries_) {
    offsets.number(channel).number(file_.at());
    std::ranges::stable_sort(entries, {}, &std::pair<std::uint64_t, std::uint64_t>::first);
    ByteBuffer array;
    for (const auto& [time_ns, offset] : entries) array.number(time_ns).number(offset);
    ByteBuffer out;
    append_record(out, Opcode::kMessageIndex, ByteBuffer().number(channel).counted(array));
    file_.write(out.bytes());
  }
  return file_.at() - start;
}

void McapSink::write_chunk() {
  if (entries_.empty()) return;
  std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  for (const auto& [channel, entries] : entries_) {
    for (const auto& [time_ns, offset] : entries) {
      first_ns = std::min(first_ns, time_ns);
      last_ns = std::max(last_ns, time_ns);
    }
  }
  const std::vector<std::byte> block = compress(chunk_.bytes(), compression_);
  const std::uint64_t size = chunk_.size();
  ByteBuffer content;
  content.number(first_ns).number(last_ns).number(size).number(crc_of(0, chunk_.bytes()));
  content.text(name_of(compression_)).number(static_cast<std::uint64_t>(block.size())).raw(block);
  const std::uint64_t start = file_.at();
  ByteBuffer out;
  append_record(out, Opcode::kChunk, content);
  file_.write(out.bytes());
  const std::uint64_t length = file_.at() - start;
  ByteBuffer offsets;
  const std::uint64_t indexes = write_message_indexes(offsets);
  ByteBuffer index;
  index.number(first_ns).number(last_ns).number(start).number(length).counted(offsets);
  index.number(indexes).text(name_of(compression_));
  index.number(static_cast<std::uint64_t>(block.size())).number(size);
  append_record(chunk_indexes_, Opcode::kChunkIndex, index);
  ++chunks_;
  chunk_.clear();
  entries_.clear();
}

void McapSink::write_summary() {
  const std::uint64_t start = file_.at();
  ByteBuffer counts;
  for (const auto& [topic, channel] : channels_) counts.number(channel.id).number(channel.messages);
  ByteBuffer statistics;
  constexpr std::uint32_t kNone = 0;  // attachments, metadata
  statistics.number(messages_).number(static_cast<std::uint16_t>(schemas_.size()));
  statistics.number(static_cast<std::uint32_t>(channels_.size())).number(kNone).number(kNone);
  statistics.number(chunks_).number(first_ns_).number(last_ns_).counted(counts);
  ByteBuffer statistics_record;
  append_record(statistics_record, Opcode::kStatistics, statistics);

  ByteBuffer summary;
  ByteBuffer offsets;
  const auto add_group = [&](Opcode opcode, const ByteBuffer& records) {
    if (records.size() == 0) return;
    append_record(offsets, Opcode::kSummaryOffset,
                  ByteBuffer()
                      .number(static_cast<std::uint8_t>(opcode))
                      .number(start + summary.size())
                      .number(static_cast<std::uint64_t>(records.size())));
    summary.raw(records.bytes());
  };
  add_group(Opcode::kSchema, schema_records_);
  add_group(Opcode::kChannel, channel_records_);
  add_group(Opcode::kStatistics, statistics_record);
  add_group(Opcode::kChunkIndex, chunk_indexes_);
  const std::uint64_t offsets_start = start + summary.size();
  summary.raw(offsets.bytes());
  // The checksum covers everything from the summary up to itself.
  constexpr std::uint64_t kFooterSize = 8 + 8 + 4;
  summary.number(static_cast<std::uint8_t>(Opcode::kFooter)).number(kFooterSize);
  summary.number(start).number(offsets_start);
  summary.number(crc_of(0, summary.bytes()));
  summary.raw(std::as_bytes(std::span(mcap::kMagic)));
  file_.write(summary.bytes());
}

void McapSink::close() {
  write_chunk();
  ByteBuffer end;
  constexpr std::uint32_t kNoCrc = 0;
  append_record(end, Opcode::kDataEnd, ByteBuffer().number(kNoCrc));
  file_.write(end.bytes());
  write_summary();
  file_.close();
}

}  // namespace topogeo::recording
