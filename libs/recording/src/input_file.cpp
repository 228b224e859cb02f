#include "input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

namespace topogeo::recording {
namespace {

constexpr std::size_t kWindow = std::size_t{1} << 20U;

std::string system_text() {
  return std::generic_category().message(errno);
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path)
    : name_(path.string()), file_(support::open_regular_file(path)) {
  struct stat facts {};
  if (::fstat(file_.get(), &facts) != 0) {
    throw std::runtime_error(name_ + ": cannot be read: " + system_text());
  }
  size_ = static_cast<std::uint64_t>(facts.st_size);
}

std::span<const std::byte> InputFile::view(std::uint64_t offset, std::size_t count) {
  if (offset >= size_) return {};
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - offset));
  const bool inside = offset >= window_start_ && offset + count <= window_start_ + window_.size();
  if (!inside) {
    window_start_ = offset;
    window_.resize(static_cast<std::size_t>(
        std::min<std::uint64_t>(std::max(count, kWindow), size_ - offset)));
    std::size_t filled = 0;
    while (filled < window_.size()) {
      const ssize_t got = ::pread(file_.get(), window_.data() + filled, window_.size() - filled,
                                  static_cast<off_t>(offset + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) {
        throw std::runtime_error(name_ + ": byte " + std::to_string(offset + filled) +
                                 ": cannot be read: " + system_text());
      }
      if (got == 0) break;  // the file was truncated after it had been opened
      filled += static_cast<std::size_t>(got);
    }
    window_.resize(filled);
    count = std::min(count, filled);
  }
  return std::span<const std::byte>(window_).subspan(
      static_cast<std::size_t>(offset - window_start_), count);
}

}  // namespace topogeo::recording
