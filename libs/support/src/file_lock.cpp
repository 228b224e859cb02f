#include "topogeo/support/file_lock.hpp"

#include <array>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "topogeo/support/host.hpp"

namespace topogeo::support {

namespace {

constexpr std::chrono::milliseconds kLockPoll{20};

std::string cause() {
  return std::generic_category().message(errno);
}

/// The text of the holder: "<host>-<process id>"; empty if it has not been written yet.
std::string holder_of(const FileDescriptor& file) {
  std::array<char, 64> text{};
  const ssize_t size = ::pread(file.get(), text.data(), text.size(), 0);
  std::string holder(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return holder.substr(0, holder.find('\n'));
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& path, std::chrono::milliseconds patience)
    : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR | S_IRGRP)) {
  if (!file_.is_open()) {
    throw std::runtime_error(path.string() + ": cannot be opened: " + cause());
  }
  const auto end = std::chrono::steady_clock::now() + patience;
  while (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) {
      throw std::runtime_error(path.string() + ": cannot be locked: " + cause());
    }
    if (std::chrono::steady_clock::now() >= end) {
      const std::string holder = holder_of(file_);
      throw std::runtime_error(path.string() + ": held by " +
                               (holder.empty() ? "another process" : "process " + holder));
    }
    std::this_thread::sleep_for(kLockPoll);
  }
  // For users only: on a full disk the lock holds all the same.
  const std::string name = process_name() + "\n";
  if (::ftruncate(file_.get(), 0) == 0) {
    static_cast<void>(::pwrite(file_.get(), name.data(), name.size(), 0));
  }
}

}  // namespace topogeo::support
