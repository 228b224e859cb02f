#include "topogeo/support/process_resources.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <unistd.h>

namespace topogeo::support {

std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");  // pages: whole address space, resident, ...
  std::uint64_t size = 0;
  std::uint64_t resident = 0;
  if (!(statm >> size >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t open_files() {
  std::error_code error;
  const std::filesystem::directory_iterator begin("/proc/self/fd", error);
  if (error) return 0;
  const auto entries = std::distance(begin, std::filesystem::directory_iterator());
  return static_cast<std::uint64_t>(entries) - 1;  // without the one used for listing
}

}  // namespace topogeo::support
