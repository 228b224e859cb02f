#include "mcap_source.hpp"

#include <algorithm>
#include <array>

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
    : file_(path), wanted_(std::move(wanted)), at_(mcap::kMagic.size()) {
  const std::span<const std::byte> magic = file_.view(0, mcap::kMagic.size());
  if (!std::ranges::equal(magic, std::as_bytes(std::span(mcap::kMagic)))) {
    throw std::runtime_error(file_.name() + ": byte 0: expected the first bytes of an MCAP file");
  }
}

bool McapSource::next(RawMessage& message) {
  while (!ended_) {
    try {
      if (chunk_at_ < chunk_.size()) {
        if (read_record_of_chunk(message)) return true;
      } else if (read_record(message)) {
        return true;
      }
    } catch (const FormatError& error) {
      // Inside a chunk the length of each record leads to the next; what follows a damaged one
      // cannot be trusted.
      damage_ = file_.name() + ": byte " + std::to_string(record_) + ": " + error.what();
      ended_ = true;
    }
  }
  return false;
}

bool McapSource::read_record(RawMessage& message) {
  record_ = at_;
  const std::span<const std::byte> head = file_.view(at_, mcap::kRecordHead);
  if (head.empty()) throw FormatError("expected the end of the data, got the end of the file");
  Cursor cursor(head);
  const auto opcode = static_cast<mcap::Opcode>(cursor.number<std::uint8_t>());
  const auto length = cursor.number<std::uint64_t>();
  const std::uint64_t start = at_ + mcap::kRecordHead;
  if (length > file_.size() - start) {
    throw FormatError("expected a record of " + std::to_string(length) +
                      " bytes, got the end of the file");
  }
  at_ = start + length;
  const auto content = [&] {
    if (length > kLargestRecord) {
      throw FormatError("expected a record of up to 1 GiB, got " + std::to_string(length) +
                        " bytes");
    }
    return file_.view(start, static_cast<std::size_t>(length));
  };
  switch (opcode) {
    case mcap::Opcode::kDataEnd:
    case mcap::Opcode::kFooter:
      ended_ = true;
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
      return false;  // indexes, attachments, what comes in later versions
  }
}

bool McapSource::read_record_of_chunk(RawMessage& message) {
  Cursor cursor(std::span<const std::byte>(chunk_).subspan(chunk_at_));
  const auto opcode = static_cast<mcap::Opcode>(cursor.number<std::uint8_t>());
  const auto length = cursor.number<std::uint64_t>();
  const std::span<const std::byte> content = cursor.take(length);
  chunk_at_ += cursor.at();
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
  const Topic topic{name, schema == schemas_.end() ? "" : ros2_type_name(schema->second), encoding};
  const auto known = std::ranges::find(topics_, topic);
  channels_[id] = {static_cast<std::size_t>(known - topics_.begin()), wanted_(topic)};
  if (known == topics_.end()) topics_.push_back(topic);
}

void McapSource::open_chunk(std::span<const std::byte> content) {
  Cursor cursor(content);
  (void)cursor.number<std::uint64_t>();  // time of the first message
  (void)cursor.number<std::uint64_t>();  // of the last
  const auto size = cursor.number<std::uint64_t>();
  const auto crc = cursor.number<std::uint32_t>();
  const Compression compression = compression_by_name(cursor.counted_text());
  const auto block = cursor.take(cursor.number<std::uint64_t>());
  chunk_.clear();
  chunk_at_ = 0;
  decompress(block, compression, size, chunk_);
  const auto sum = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(chunk_.data()), chunk_.size()));
  if (crc != 0 && crc != sum) {
    chunk_.clear();
    throw FormatError("expected a chunk of CRC " + std::to_string(crc) + ", got " +
                      std::to_string(sum));
  }
}

std::string McapSource::position() const {
  return "byte " + std::to_string(record_);
}

double McapSource::fraction_read() const {
  return ended_ ? 1.0
                : static_cast<double>(at_) /
                      static_cast<double>(std::max<std::uint64_t>(file_.size(), 1));
}

}  // namespace topogeo::recording
