#include "gz_lines.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <sys/stat.h>

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::scan {

GzLines::GzLines(const std::filesystem::path& path) {
  support::FileDescriptor file = support::open_regular_file(path);
  struct stat status {};
  if (::fstat(file.get(), &status) == 0) {
    size_on_disk_ = static_cast<std::uint64_t>(status.st_size);
  }
  file_.reset(gzdopen(file.get(), "rb"));
  if (!file_) throw std::runtime_error(path.string() + ": cannot be opened: no memory");
  static_cast<void>(file.release());  // closed with file_
}

void GzLines::fill() {
  constexpr unsigned kChunk = 1U << 16U;
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t used = buffer_.size();
  buffer_.resize(used + kChunk);
  const int got = gzread(file_.get(), buffer_.data() + used, kChunk);
  buffer_.resize(used + static_cast<std::size_t>(std::max(got, 0)));
  bytes_ += static_cast<std::uint64_t>(std::max(got, 0));
  if (got == static_cast<int>(kChunk)) return;
  int code = Z_OK;
  const char* message = gzerror(file_.get(), &code);
  if (code == Z_ERRNO) {
    damage_ = std::strerror(errno);
  } else if (code != Z_OK && code != Z_STREAM_END) {
    damage_ = message;
  }
  ended_ = got <= 0 || !damage_.empty();
}

bool GzLines::next(Line& line) {
  line = {};
  std::size_t searched = begin_;
  while (true) {
    const std::size_t end = buffer_.find('\n', searched);
    if (end != std::string::npos) {
      if (!line.too_long) line.text = std::string_view(buffer_).substr(begin_, end - begin_);
      begin_ = end + 1;
      break;
    }
    if (ended_) {
      const bool rest = begin_ < buffer_.size() || line.too_long;
      if (!rest || !damage_.empty()) return false;
      if (!line.too_long) line.text = std::string_view(buffer_).substr(begin_);
      begin_ = buffer_.size();
      break;
    }
    if (buffer_.size() - begin_ > kMaxLine) {
      line.too_long = true;
      begin_ = buffer_.size();
    }
    searched = buffer_.size() - begin_;
    fill();
  }
  if (line.text.ends_with('\r')) line.text.remove_suffix(1);
  return true;
}

double GzLines::fraction_read() const {
  if (size_on_disk_ == 0) return ended_ ? 1.0 : 0.0;
  const auto offset = gzoffset(file_.get());
  if (offset < 0) return ended_ ? 1.0 : 0.0;
  return std::min(1.0, static_cast<double>(offset) / static_cast<double>(size_on_disk_));
}

}  // namespace topogeo::scan
