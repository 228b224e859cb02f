#include "bag_source.hpp"

#include <utility>

#include "topogeo/recording/ros_definitions.hpp"

#include "bag_format.hpp"
#include "compression.hpp"

namespace topogeo::recording {
namespace {

constexpr std::uint32_t kLargestHeader = std::uint32_t{1} << 24U;

std::map<std::string, std::span<const std::byte>, std::less<>> header_fields(
    std::span<const std::byte> header) {
  std::map<std::string, std::span<const std::byte>, std::less<>> fields;
  Cursor cursor(header);
  while (cursor.left() > 0) {
    const std::string_view field = cursor.counted_text();
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw FormatError("expected name=value in a header");
    fields[std::string(field.substr(0, equals))] =
        std::as_bytes(std::span(field.substr(equals + 1)));
  }
  return fields;
}

std::span<const std::byte> field_of(
    const std::map<std::string, std::span<const std::byte>, std::less<>>& fields,
    std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) {
    throw FormatError("expected the field " + std::string(name) + " in a header");
  }
  return found->second;
}

template <typename Value>
Value number_of(const std::map<std::string, std::span<const std::byte>, std::less<>>& fields,
                std::string_view name) {
  return Cursor(field_of(fields, name)).number<Value>();
}

std::string text_of_field(
    const std::map<std::string, std::span<const std::byte>, std::less<>>& fields,
    std::string_view name) {
  const std::span<const std::byte> value = field_of(fields, name);
  return {reinterpret_cast<const char*>(value.data()), value.size()};
}

}  // namespace

BagSource::BagSource(const std::filesystem::path& path, TopicFilter wanted)
    : ChunkedSource(path, std::move(wanted), std::as_bytes(std::span(bag::kMagic)),
                    "a bag of version 2.0, '#ROSBAG V2.0'") {}

bool BagSource::read_record(RawMessage& message) {
  if (at() >= file().size()) {
    end();
    return false;
  }
  constexpr std::size_t kLength = sizeof(std::uint32_t);
  const auto header_length = Cursor(file().view(at(), kLength)).number<std::uint32_t>();
  if (header_length > kLargestHeader) {
    throw FormatError("expected a header of up to 16 MiB, got " + std::to_string(header_length) +
                      " bytes");
  }
  const std::uint64_t data_length_at = at() + kLength + header_length;
  const auto data_length = Cursor(file().view(data_length_at, kLength)).number<std::uint32_t>();
  const std::uint64_t end_at = data_length_at + kLength + data_length;
  if (end_at > file().size()) {
    throw FormatError("expected a record of " + std::to_string(end_at - at()) +
                      " bytes, got the end of the file");
  }
  if (data_length > kLargestBlock) throw FormatError("expected a record of up to 256 MiB");
  Cursor record(file().view(at(), static_cast<std::size_t>(end_at - at())));
  move_to(end_at);
  const Fields header = header_fields(record.take(record.number<std::uint32_t>()));
  const std::span<const std::byte> data = record.take(record.number<std::uint32_t>());
  if (number_of<std::uint8_t>(header, "op") == bag::kChunk) {
    open_chunk(header, data);
    return false;
  }
  return take(header, data, message);
}

bool BagSource::read_record_of_chunk(Cursor& cursor, RawMessage& message) {
  const Fields header = header_fields(cursor.take(cursor.number<std::uint32_t>()));
  const std::span<const std::byte> data = cursor.take(cursor.number<std::uint32_t>());
  return take(header, data, message);
}

bool BagSource::take(const Fields& header, std::span<const std::byte> data, RawMessage& message) {
  const auto op = number_of<std::uint8_t>(header, "op");
  if (op == bag::kConnection) take_connection(header, data);
  if (op == bag::kFileHeader && header.contains("encryptor")) {
    const std::string encryptor = text_of_field(header, "encryptor");
    if (!encryptor.empty()) throw FormatError("expected no encryption, got " + encryptor);
  }
  if (op != bag::kMessage) return false;
  const auto id = number_of<std::uint32_t>(header, "conn");
  const auto connection = connections_.find(id);
  if (connection == connections_.end()) {
    throw FormatError("expected a connection before its message, got connection " +
                      std::to_string(id));
  }
  if (!connection->second.wanted) return false;
  Cursor time(field_of(header, "time"));
  const std::int64_t seconds = time.number<std::uint32_t>();
  message.topic = connection->second.topic;
  message.log_time_ns = seconds * 1'000'000'000 + time.number<std::uint32_t>();
  message.data = data;
  return true;
}

void BagSource::take_connection(const Fields& header, std::span<const std::byte> data) {
  const Fields facts = header_fields(data);
  Topic topic{text_of_field(header, "topic"), ros2_type_name(text_of_field(facts, "type")),
              Encoding::kRos1};
  const RosDefinition* definition = find_definition(topic.type);
  const std::string md5 = text_of_field(facts, "md5sum");
  // Another version of a known message has other fields.
  if (definition != nullptr && !definition->ros1_md5.empty() && md5 != "*" &&
      md5 != definition->ros1_md5) {
    topic.type += " (md5 " + md5 + ")";
    topic.encoding = Encoding::kOther;
  }
  connections_[number_of<std::uint32_t>(header, "conn")] = channel_of(topic);
}

void BagSource::open_chunk(const Fields& header, std::span<const std::byte> data) {
  decompress(data, compression_by_name(text_of_field(header, "compression")),
             number_of<std::uint32_t>(header, "size"), budget(), begin_chunk());
}

}  // namespace topogeo::recording
