#include "disk_room.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "topogeo/service/service.hpp"
#include "topogeo/support/file_descriptor.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::map_store {
namespace {

/// More than opening a database takes: its log and the index of the log.
constexpr std::size_t kRoom_bytes = std::size_t{1} << 20U;
constexpr std::chrono::seconds kRoomPeriod{2};

bool is_lack_of_room(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

/// Returns zero or the errno of the failure.
int write_and_sync(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  // Some file systems detect a lack of room only here.
  return ::fsync(file) == 0 ? 0 : errno;
}

bool has_room(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return !is_lack_of_room(error.value());
  const std::filesystem::path probe = directory / fmt::format(".room-{}", ::getpid());
  const support::FileDescriptor file(
      ::open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open()) return !is_lack_of_room(errno);
  const int cause = write_and_sync(file.get(), std::string(kRoom_bytes, '\0'));
  ::unlink(probe.c_str());
  return !is_lack_of_room(cause);
}

}  // namespace

bool have_room(std::span<const std::filesystem::path> directories) {
  return std::ranges::all_of(directories, has_room);
}

bool wait_for_room(const service::Setup& setup, std::span<const std::filesystem::path> directories,
                   const std::string& why) {
  service::Service service(setup);
  const std::string reason = "waiting for disk space: " + why;
  service.status().fault("disk full", why);
  service.status().set_state(msg::kServiceFailed, reason);
  bool room = false;
  service.loop().add_timer(kRoomPeriod, [&] {
    room = have_room(directories);
    if (room) {
      service.loop().stop();
    } else {
      service.status().fault("disk full", why);
    }
  });
  service.run();
  if (room) spdlog::info("disk space is available again");
  return room && !service::Service::stopping();
}

}  // namespace topogeo::map_store
