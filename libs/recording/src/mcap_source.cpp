#include "mcap_source.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <zlib.h>

#include "compression.hpp"
#include "mcap_format.hpp"

namespace topogeo::recording {
namespace {

constexpr std::uint64_t kLargestRecord = kLargestBlock + 1024;

Encoding encoding_of_channel(std::string_view message_encoding) {
  if (message_encoding == "cdr") return Encoding::kCdr;
  if (message_encoding == "ros1") return Encoding::kRos1;
  return Encoding::kOther;
}

}  // namespace

McapSource::McapSource(const std::filesystem::path& path, TopicFilter wanted)
    : ChunkedSource(path, std::move(wanted), std::as_bytes(std::span(mcap::kMagic)),
                    "the first bytes of an MCAP file") {
  take_summary(read_summary(file()));
}

void McapSource::take_summary(const McapSummary& summary) {
  try {
    for (const std::vector<std::byte>& schema : summary.schemas) take_schema(schema);
    for (const std::vector<std::byte>& channel : summary.channels) take_channel(channel);
  } catch (const FormatError&) {
    return;  // the data section repeats them
  }
  // A channel missing from the summary could only be learned from a skipped chunk.
  const auto is_known = [this](std::uint16_t id) { return channels_.contains(id); };
  const auto is_unwanted = [this](std::uint16_t id) { return !channels_.at(id).wanted; };
  const auto states_channels = [&](const auto& entry) {
    return !entry.second.channels.empty() && std::ranges::all_of(entry.second.channels, is_known);
  };
  if (!std::ranges::all_of(summary.chunks, states_channels)) return;
  for (const auto& [start, chunk] : summary.chunks) {
    if (std::ranges::all_of(chunk.channels, is_unwanted)) unwanted_chunks_[start] = chunk.end;
  }
}

bool McapSource::read_record(RawMessage& message) {
  if (const auto unwanted = unwanted_chunks_.find(at()); unwanted != unwanted_chunks_.end()) {
    move_to(unwanted->second);
    return false;
  }
  const std::span<const std::byte> head = file().view(at(), mcap::kRecordHead);
  if (head.empty()) throw FormatError("expected the end of the data, got the end of the file");
  Cursor cursor(head);
  const auto opcode = static_cast<mcap::Opcode>(cursor.number<std::uint8_t>());
  const auto length = cursor.number<std::uint64_t>();
  if (opcode == mcap::Opcode::kNone) throw FormatError("expected a record, got zeros");
  const std::uint64_t start = at() + mcap::kRecordHead;
  if (length > file().size() - start) {
    throw FormatError("expected a record of " + std::to_string(length) +
                      " bytes, got the end of the file");
  }
  move_to(start + length);
  const auto content = [&] {
    if (length > kLargestRecord) {
      throw FormatError("expected a record of up to 256 MiB, got " + std::to_string(length) +
                        " bytes");
    }
    return file().view(start, static_cast<std::size_t>(length));
  };
  switch (opcode) {
    case mcap::Opcode::kDataEnd:
    case mcap::Opcode::kFooter:
      end();
      return false;
    case mcap::Opcode::kSchema:
      take_schema(content());
      return false;
    case mcap::Opcode::kChannel:
      take_channel(content());
      return false;
    case mcap::Opcode::kChunk:
      open_chunk(content());
      return false;
    case mcap::Opcode::kMessage:
      return take_message(content(), message);
    default:
      return false;  // indexes, attachments, records of later versions
  }
}

bool McapSource::read_record_of_chunk(Cursor& cursor, RawMessage& message) {
  const auto opcode = static_cast<mcap::Opcode>(cursor.number<std::uint8_t>());
  const auto length = cursor.number<std::uint64_t>();
  const std::span<const std::byte> content = cursor.take(length);
  switch (opcode) {
    case mcap::Opcode::kSchema:
      take_schema(content);
      return false;
    case mcap::Opcode::kChannel:
      take_channel(content);
      return false;
    case mcap::Opcode::kMessage:
      return take_message(content, message);
    default:
      return false;
  }
}

bool McapSource::take_message(std::span<const std::byte> content, RawMessage& message) {
  Cursor cursor(content);
  const auto id = cursor.number<std::uint16_t>();
  const auto channel = channels_.find(id);
  if (channel == channels_.end()) {
    throw FormatError("expected a channel before its message, got channel " + std::to_string(id));
  }
  if (!channel->second.wanted) return false;
  (void)cursor.number<std::uint32_t>();  // sequence
  message.topic = channel->second.topic;
  message.log_time_ns = static_cast<std::int64_t>(cursor.number<std::uint64_t>());
  (void)cursor.number<std::uint64_t>();  // publish time
  message.data = cursor.take(cursor.left());
  // Recorders with compression_mode message leave the encoding of the channel as it is.
  if (topics()[message.topic].encoding == Encoding::kCdr && is_zstd_frame(message.data)) {
    decompress_zstd(message.data, budget(), unpacked_message_);
    message.data = unpacked_message_;
  }
  return true;
}

void McapSource::take_schema(std::span<const std::byte> content) {
  Cursor cursor(content);
  const auto id = cursor.number<std::uint16_t>();
  schemas_[id] = std::string(cursor.counted_text());
}

void McapSource::take_channel(std::span<const std::byte> content) {
  Cursor cursor(content);
  const auto id = cursor.number<std::uint16_t>();
  const auto schema = schemas_.find(cursor.number<std::uint16_t>());
  const std::string name(cursor.counted_text());
  const Encoding encoding = encoding_of_channel(cursor.counted_text());
  channels_[id] =
      channel_of({name, schema == schemas_.end() ? "" : ros2_type_name(schema->second), encoding});
}

void McapSource::open_chunk(std::span<const std::byte> content) {
  Cursor cursor(content);
  (void)cursor.number<std::uint64_t>();  // time of the first message
  (void)cursor.number<std::uint64_t>();  // of the last
  const auto size = cursor.number<std::uint64_t>();
  const auto crc = cursor.number<std::uint32_t>();
  const Compression compression = compression_by_name(cursor.counted_text());
  const auto block = cursor.take(cursor.number<std::uint64_t>());
  std::vector<std::byte>& chunk = begin_chunk();
  decompress(block, compression, size, budget(), chunk);
  const auto sum = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(chunk.data()), chunk.size()));
  if (crc != 0 && crc != sum) {
    throw FormatError("expected a chunk of CRC " + std::to_string(crc) + ", got " +
                      std::to_string(sum));
  }
}

}  // namespace topogeo::recording
