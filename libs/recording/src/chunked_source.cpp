#include "chunked_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace topogeo::recording {

ChunkedSource::ChunkedSource(const std::filesystem::path& path, TopicFilter wanted,
                             std::span<const std::byte> magic, std::string_view expected)
    : file_(path), budget_(file_.size()), wanted_(std::move(wanted)), at_(magic.size()) {
  if (!std::ranges::equal(file_.view(0, magic.size()), magic)) {
    throw std::runtime_error(file_.name() + ": byte 0: expected " + std::string(expected));
  }
}

bool ChunkedSource::next(RawMessage& message) {
  while (!ended_) {
    const bool in_chunk = chunk_at_ < chunk_.size();
    try {
      if (in_chunk) {
        Cursor cursor(std::span<const std::byte>(chunk_).subspan(chunk_at_));
        const bool found = read_record_of_chunk(cursor, message);
        chunk_at_ += cursor.at();
        if (found) return true;
      } else {
        record_ = at_;
        if (read_record(message)) return true;
      }
    } catch (const FormatError& error) {
      if (damage_.empty()) {
        damage_ = file_.name() + ": byte " + std::to_string(record_) + ": " + error.what();
      }
      // Inside a chunk the length of each record leads to the next one, so nothing after a damaged
      // record can be trusted. The length of the chunk leads to the next chunk.
      begin_chunk();
      if (!in_chunk && at_ == record_) ended_ = true;
    }
  }
  return false;
}

ChunkedSource::Channel ChunkedSource::channel_of(const Topic& topic) {
  const auto known = std::ranges::find(topics_, topic);
  const Channel channel{static_cast<std::size_t>(known - topics_.begin()), wanted_(topic)};
  if (known == topics_.end()) topics_.push_back(topic);
  return channel;
}

std::vector<std::byte>& ChunkedSource::begin_chunk() {
  chunk_.clear();
  chunk_at_ = 0;
  return chunk_;
}

std::string ChunkedSource::position() const {
  return "byte " + std::to_string(record_);
}

double ChunkedSource::fraction_read() const {
  return ended_ ? 1.0 : static_cast<double>(at_) / static_cast<double>(file_.size());
}

}  // namespace topogeo::recording
