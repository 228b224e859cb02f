#include "topogeo/support/host.hpp"

#include <array>
#include <chrono>

#include <unistd.h>

#include "topogeo/support/file_content.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::support {

std::string host_name() {
  std::array<char, 65> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unknown";
  return name.data();
}

std::string process_name() {
  constexpr std::size_t kLongestHost = 32;
  return host_name().substr(0, kLongestHost) + "-" + std::to_string(::getpid());
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

}  // namespace topogeo::support
