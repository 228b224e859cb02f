#include "topogeo/support/host.hpp"

#include <array>
#include <chrono>

#include <sys/stat.h>
#include <unistd.h>

#include "topogeo/support/file_content.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::support {

namespace {

/// The process id; in a container with the number of its PID namespace, because containers with
/// the name of their host count their processes each from 1.
std::string process_number() {
  constexpr ino_t kFirstNamespace = 0xEFFFFFFC;  // of the machine: PROC_PID_INIT_INO of the kernel
  struct stat own {};
  const bool contained = ::stat("/proc/self/ns/pid", &own) == 0 && own.st_ino != kFirstNamespace;
  return std::to_string(::getpid()) + (contained ? "." + std::to_string(own.st_ino) : "");
}

}  // namespace

std::string host_name() {
  std::array<char, 65> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unknown";
  return name.data();
}

std::string process_name() {
  constexpr std::size_t kLongest = 50;
  const std::string number = process_number();
  return host_name().substr(0, kLongest - 1 - number.size()) + "-" + number;
}

std::uint64_t this_boot() {
  static const std::uint64_t boot = fnv1a(file_content("/proc/sys/kernel/random/boot_id"));
  return boot;
}

std::int64_t wall_clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::int64_t monotonic_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace topogeo::support
