#include "topogeo/service/runtime_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "topogeo/support/file_descriptor.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::service {
namespace {

/// Makes a file name: no folders in it.
std::string without_slashes(std::string text) {
  std::ranges::replace(text, '/', '_');
  return text;
}

/// Opens or creates the file. Returns why it cannot be used; empty: it can. Anybody may have
/// created a file of that name in /dev/shm.
std::string why_unusable(const std::filesystem::path& file) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;  // a pipe waits
  const support::FileDescriptor opened(::open(file.c_str(), kFlags, 0600));
  struct stat found {};
  if (!opened.is_open() || ::fstat(opened.get(), &found) != 0) {
    return "cannot be written: " + std::generic_category().message(errno);
  }
  if (!S_ISREG(found.st_mode)) return "is no regular file";
  if (found.st_uid != ::geteuid()) return "belongs to another user";
  return {};
}

}  // namespace

std::filesystem::path runtime_file(const Setup& setup, std::string_view ending) {
  const char* given = std::getenv("RUNTIME_DIRECTORY");  // NOLINT(concurrency-mt-unsafe): not set
  std::string folder = given == nullptr ? "" : given;
  folder = folder.substr(0, folder.find(':'));
  if (folder.empty()) folder = "/dev/shm";
  const ServiceOptions& options = setup.options;
  std::string name = "topogeo-" + without_slashes(options.partition) + "." +
                     std::to_string(options.domain) + "-" + without_slashes(options.robot_id) +
                     "-" + setup.name;
  name += ending;
  return std::filesystem::path(folder) / name;
}

std::filesystem::path own_runtime_file(const Setup& setup, std::string_view ending,
                                       std::string_view loss) {
  std::string of_user = "." + std::to_string(::geteuid());
  of_user += ending;
  std::filesystem::path file = runtime_file(setup, of_user);
  const std::string why = why_unusable(file);
  if (why.empty()) return file;
  spdlog::warn("{}: {}; {}", file.string(), why, loss);
  return {};
}

}  // namespace topogeo::service
