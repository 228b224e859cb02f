#include "topogeo/support/atomic_file.hpp"

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "topogeo/support/file_descriptor.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/secret_file.hpp"

namespace topogeo::support {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what, int error) {
  throw std::runtime_error(path.string() + ": " + what + ": " +
                           std::generic_category().message(error));
}

/// Removes the file at the end of its life unless it was kept.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!kept_) ::unlink(path_.c_str());
  }
  void keep() { kept_ = true; }

 private:
  fs::path path_;
  bool kept_ = false;
};

fs::path directory_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Creates a new file with the permissions that the umask allows. Returns its descriptor, or -1
/// with errno.
int create_beside(const fs::path& path, fs::path& created, mode_t mode = 0666) {
  constexpr int kAttempts = 100;  // leftovers of killed processes with this process's id
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    created = directory_of(path) /
              fmt::format(".{}.tmp-{}-{}", path.filename().string(), ::getpid(), attempt);
    const int fd = ::open(created.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

/// Zero, or the errno of the failure.
int write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

void write_with_mode(const fs::path& path, std::string_view content, mode_t mode) {
  if (!path.has_filename()) fail(path, "cannot be written", EISDIR);
  fs::path temporary_path;
  FileDescriptor file(create_beside(path, temporary_path, mode));
  if (file.get() < 0) fail(path, "cannot be created", errno);
  TemporaryFile temporary(temporary_path);

  if (const int error = write_all(file.get(), content)) fail(path, "cannot be written", error);
  if (::fsync(file.get()) != 0) fail(path, "cannot be synced to disk", errno);
  if (!file.close()) fail(path, "cannot be written", errno);
  if (::rename(temporary_path.c_str(), path.c_str()) != 0) fail(path, "cannot be replaced", errno);
  temporary.keep();

  // Without this a power failure could lose the new name, though not the content. Some file systems
  // do not support it; the file is written all the same.
  const FileDescriptor directory(
      ::open(directory_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.get() >= 0) static_cast<void>(::fsync(directory.get()));
}

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view content) {
  write_with_mode(path, content, 0666);
}

void write_secret_file(const fs::path& path, std::string_view content) {
  write_with_mode(path, content, S_IRUSR | S_IWUSR);
}

void check_writable_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) fail(directory, "cannot be created", error.value());
  if (!fs::is_directory(directory, error)) fail(directory, "is no directory", ENOTDIR);
  fs::path probe_path;
  FileDescriptor probe(create_beside(directory / "write-check", probe_path));
  if (probe.get() < 0) fail(directory, "cannot be written", errno);
  const TemporaryFile temporary(probe_path);
  if (const int cause = write_all(probe.get(), "x")) fail(directory, "cannot be written", cause);
  if (!probe.close()) fail(directory, "cannot be written", errno);
}

}  // namespace topogeo::support
