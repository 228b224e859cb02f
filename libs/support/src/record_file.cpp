#include "topogeo/support/record_file.hpp"

#include <cerrno>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "topogeo/support/hash.hpp"

namespace topogeo::support {
namespace {

constexpr std::size_t kNumber_bytes = sizeof(std::uint64_t);

FileDescriptor open_record(const std::filesystem::path& path) {
  if (path.empty()) return FileDescriptor();
  FileDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644));
  if (!file.is_open()) {
    throw std::runtime_error(path.string() +
                             ": cannot be opened: " + std::generic_category().message(errno));
  }
  return file;
}

/// Content of the file: format, record, hash of both.
std::string framed(std::uint64_t format, std::string_view record) {
  std::string out(kNumber_bytes, '\0');
  std::memcpy(out.data(), &format, kNumber_bytes);
  out += record;
  const std::uint64_t hash = fnv1a(out);
  out.resize(out.size() + kNumber_bytes);
  std::memcpy(out.data() + out.size() - kNumber_bytes, &hash, kNumber_bytes);
  return out;
}

}  // namespace

RecordFileBytes::RecordFileBytes(const std::filesystem::path& path, std::uint64_t format)
    : file_(open_record(path)), format_(format) {}

bool RecordFileBytes::load(std::span<std::byte> bytes) const {
  if (!file_.is_open()) return false;
  std::string there(bytes.size() + 2 * kNumber_bytes + 1, '\0');  // detects a longer file
  const ssize_t count = ::pread(file_.get(), there.data(), there.size(), 0);
  if (count != static_cast<ssize_t>(there.size() - 1)) return false;
  there.pop_back();
  const std::string_view record = std::string_view(there).substr(kNumber_bytes, bytes.size());
  if (there != framed(format_, record)) return false;
  std::memcpy(bytes.data(), record.data(), record.size());
  return true;
}

bool RecordFileBytes::store(std::span<const std::byte> bytes) const {
  if (!file_.is_open()) return true;
  const std::string out =
      framed(format_, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const ssize_t written = ::pwrite(file_.get(), out.data(), out.size(), 0);
  // Neither the previous record nor the end of a longer file may remain. One byte is damaged, where
  // no byte would be a file without a record.
  const bool whole = written == static_cast<ssize_t>(out.size());
  static_cast<void>(::ftruncate(file_.get(), whole ? written : 1));
  return whole;
}

}  // namespace topogeo::support
