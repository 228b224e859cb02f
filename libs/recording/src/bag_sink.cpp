#include "bag_sink.hpp"

#include <algorithm>

#include "topogeo/recording/ros_definitions.hpp"

#include "bag_format.hpp"

namespace topogeo::recording {
namespace {

constexpr std::size_t kBagChunkSize = std::size_t{768} * 1024;  // rosbag's own
constexpr std::size_t kHeaderEnd = 4096;

/// Fields of a header, each as its length and name=value.
class HeaderFields {
 public:
  HeaderFields& text(std::string_view name, std::string_view value) {
    bytes_.number(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    bytes_.raw(name).raw("=").raw(value);
    return *this;
  }
  template <typename Value>
  HeaderFields& number(std::string_view name, Value value) {
    return text(name, {reinterpret_cast<const char*>(&value), sizeof(Value)});
  }
  [[nodiscard]] const ByteBuffer& bytes() const { return bytes_; }

 private:
  ByteBuffer bytes_;
};

void append_bag_record(ByteBuffer& out, const HeaderFields& header,
                       std::span<const std::byte> data) {
  out.counted(header.bytes()).number(static_cast<std::uint32_t>(data.size())).raw(data);
}

/// Seconds in the lower half, nanoseconds in the upper, which gives the bytes of a bag's time.
std::uint64_t bag_time(std::int64_t time_ns) {
  const auto ns = static_cast<std::uint64_t>(time_ns);
  return (ns % 1'000'000'000U) << 32U | (ns / 1'000'000'000U & 0xFFFFFFFFU);
}

bool is_before(std::uint64_t a, std::uint64_t b) {
  return std::pair(a & 0xFFFFFFFFU, a >> 32U) < std::pair(b & 0xFFFFFFFFU, b >> 32U);
}

std::string_view bag_name_of(Compression compression) {
  if (compression == Compression::kBz2) return "bz2";
  return compression == Compression::kLz4 ? "lz4" : "none";
}

}  // namespace

BagSink::BagSink(const std::filesystem::path& path, Compression compression)
    : file_(path), compression_(compression) {
  file_.write(std::as_bytes(std::span(bag::kMagic)));
  write_header(0);
}

void BagSink::write_header(std::uint64_t index_position) {
  const HeaderFields header =
      HeaderFields()
          .number("op", bag::kFileHeader)
          .number("index_pos", index_position)
          .number("conn_count", static_cast<std::uint32_t>(connections_.size()))
          .number("chunk_count", chunks_);
  ByteBuffer record;
  const std::string blanks(kHeaderEnd - header.bytes().size(), ' ');
  append_bag_record(record, header, std::as_bytes(std::span(blanks)));
  if (file_.at() == bag::kMagic.size()) {
    file_.write(record.bytes());
  } else {
    file_.write_at(bag::kMagic.size(), record.bytes());
  }
}

std::uint32_t BagSink::connection_of(const OutputMessage& message) {
  const auto known = connections_.find(message.topic);
  if (known != connections_.end()) return known->second;
  const RosDefinition* definition = find_definition(message.type);
  if (definition == nullptr || definition->ros1_md5.empty()) {
    throw std::runtime_error(message.topic + ": expected a message type of ROS 1, got " +
                             std::string(message.type));
  }
  const auto id = static_cast<std::uint32_t>(connections_.size());
  const HeaderFields facts = HeaderFields()
                                 .text("topic", message.topic)
                                 .text("type", ros1_type_name(message.type))
                                 .text("md5sum", definition->ros1_md5)
                                 .text("message_definition", ros1_definition_text(message.type))
                                 .text("latching", is_latched(message.topic) ? "1" : "0");
  const HeaderFields header =
      HeaderFields().number("op", bag::kConnection).number("conn", id).text("topic", message.topic);
  append_bag_record(chunk_, header, facts.bytes().bytes());
  append_bag_record(connection_records_, header, facts.bytes().bytes());
  connections_.emplace(message.topic, id);
  return id;
}

void BagSink::write(const OutputMessage& message) {
  const std::uint32_t id = connection_of(message);
  const std::uint64_t time = bag_time(message.time_ns);
  if (entries_.empty()) chunk_first_ = chunk_last_ = time;
  if (is_before(time, chunk_first_)) chunk_first_ = time;
  if (is_before(chunk_last_, time)) chunk_last_ = time;
  entries_[id].emplace_back(time, static_cast<std::uint32_t>(chunk_.size()));
  append_bag_record(
      chunk_, HeaderFields().number("op", bag::kMessage).number("conn", id).number("time", time),
      message.data);
  if (chunk_.size() >= kBagChunkSize) write_chunk();
}

void BagSink::write_chunk() {
  if (entries_.empty()) return;
  const std::uint64_t position = file_.at();
  ByteBuffer out;
  append_bag_record(out,
                    HeaderFields()
                        .number("op", bag::kChunk)
                        .text("compression", bag_name_of(compression_))
                        .number("size", static_cast<std::uint32_t>(chunk_.size())),
                    compress(chunk_.bytes(), compression_));
  constexpr std::uint32_t kVersion = 1;
  ByteBuffer counts;
  for (auto& [id, entries] : entries_) {
    std::ranges::stable_sort(
        entries, [](const auto& a, const auto& b) { return is_before(a.first, b.first); });
    ByteBuffer index;
    for (const auto& [time, offset] : entries) index.number(time).number(offset);
    const auto count = static_cast<std::uint32_t>(entries.size());
    append_bag_record(out,
                      HeaderFields()
                          .number("op", bag::kIndex)
                          .number("ver", kVersion)
                          .number("conn", id)
                          .number("count", count),
                      index.bytes());
    counts.number(id).number(count);
  }
  file_.write(out.bytes());
  append_bag_record(chunk_infos_,
                    HeaderFields()
                        .number("op", bag::kChunkInfo)
                        .number("ver", kVersion)
                        .number("chunk_pos", position)
                        .number("start_time", chunk_first_)
                        .number("end_time", chunk_last_)
                        .number("count", static_cast<std::uint32_t>(entries_.size())),
                    counts.bytes());
  ++chunks_;
  chunk_.clear();
  entries_.clear();
}

void BagSink::close() {
  write_chunk();
  const std::uint64_t index_position = file_.at();
  file_.write(connection_records_.bytes());
  file_.write(chunk_infos_.bytes());
  write_header(index_position);
  file_.close();
}

}  // namespace topogeo::recording
