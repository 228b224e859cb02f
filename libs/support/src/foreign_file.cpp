#include "topogeo/support/foreign_file.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "topogeo/support/format.hpp"

namespace topogeo::support {
namespace {

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

void require_regular(const std::filesystem::path& path, const struct stat& status) {
  if (S_ISREG(status.st_mode)) return;
  throw std::runtime_error(
      fmt::format("{}: is {}, expected a regular file", path.string(), kind_of(status.st_mode)));
}

[[noreturn]] void fail_with_cause(const std::filesystem::path& path, const char* what) {
  const int cause = errno;
  throw std::runtime_error(
      fmt::format("{}: {}: {}", path.string(), what, std::generic_category().message(cause)));
}

/// Reads up to `count` bytes from the current position.
std::string read_bytes(const FileDescriptor& file, std::size_t count,
                       const std::filesystem::path& path) {
  std::string bytes;
  while (bytes.size() < count) {
    // Files of /proc have no size, so memory grows with the bytes read.
    constexpr std::size_t kChunk = std::size_t{1} << 20U;
    const std::size_t used = bytes.size();
    bytes.resize(std::min(count, std::max(used + kChunk, bytes.capacity())));
    const ssize_t got = ::read(file.get(), bytes.data() + used, bytes.size() - used);
    bytes.resize(used + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_with_cause(path, "cannot be read");
    if (got == 0) break;
  }
  return bytes;
}

}  // namespace

FileDescriptor open_regular_file(const std::filesystem::path& path) {
  // Without O_NONBLOCK, opening a FIFO waits for its writer.
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open()) {
    // A socket cannot be opened, and maybe a device neither.
    const int cause = errno;
    if (::stat(path.c_str(), &status) == 0) require_regular(path, status);
    errno = cause;
    fail_with_cause(path, "cannot be opened");
  }
  if (::fstat(file.get(), &status) != 0) fail_with_cause(path, "cannot be read");
  require_regular(path, status);
  return file;
}

std::string foreign_content(const std::filesystem::path& path, std::uint64_t most) {
  const FileDescriptor file = open_regular_file(path);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) fail_with_cause(path, "cannot be read");
  const auto require_fits = [&](std::uint64_t size) {
    if (size <= most) return;
    throw std::runtime_error(
        fmt::format("{}: is {} bytes, expected at most {}", path.string(), size, most));
  };
  require_fits(static_cast<std::uint64_t>(status.st_size));
  // One byte more, to detect a file that grows meanwhile.
  std::string content = read_bytes(file, static_cast<std::size_t>(most) + 1, path);
  require_fits(content.size());
  return content;
}

std::string first_bytes(const std::filesystem::path& path, std::size_t count) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  return read_bytes(open_regular_file(path), count, path);
}

void refuse_irregular(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) require_regular(path, status);
}

}  // namespace topogeo::support
