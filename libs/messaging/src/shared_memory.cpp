#include "topogeo/messaging/shared_memory.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::messaging {

namespace {

namespace fs = std::filesystem;

/// The name of the segment of a lock "fastrtps_0123456789abcdef_el" (Fast DDS 2.9.1) or
/// "fastdds_0123456789abcdef_el" (3); empty for other files, such as the locks of ports.
std::string segment_of(std::string_view lock) {
  constexpr std::string_view kSuffix = "_el";
  constexpr std::size_t kDigits = 16;
  for (const std::string_view prefix : {"fastrtps_", "fastdds_"}) {
    if (lock.size() != prefix.size() + kDigits + kSuffix.size() || !lock.starts_with(prefix) ||
        !lock.ends_with(kSuffix)) {
      continue;
    }
    const std::string_view digits = lock.substr(prefix.size(), kDigits);
    if (digits.find_first_not_of("0123456789abcdef") != std::string_view::npos) continue;
    return std::string(lock.substr(0, prefix.size() + kDigits));
  }
  return {};
}

bool is_dead(const fs::path& lock, std::chrono::seconds age) {
  std::error_code error;
  const auto made = fs::last_write_time(lock, error);
  if (error || fs::file_time_type::clock::now() - made < age) return false;
  const support::FileDescriptor file(::open(lock.c_str(), O_RDONLY | O_CLOEXEC));
  return file.is_open() && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

std::vector<DeadSegment> find_dead_segments(const fs::path& folder, std::chrono::seconds age) {
  std::vector<DeadSegment> dead;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string segment = segment_of(entry->path().filename().string());
    if (segment.empty() || !is_dead(entry->path(), age)) continue;
    std::error_code unknown;
    const std::uintmax_t bytes = fs::file_size(folder / segment, unknown);
    dead.push_back({folder / segment, unknown ? 0 : bytes});
  }
  std::ranges::sort(dead, {}, &DeadSegment::file);
  return dead;
}

std::size_t remove_dead_segments(const fs::path& folder, std::chrono::seconds age) {
  std::size_t removed = 0;
  for (const DeadSegment& segment : find_dead_segments(folder, age)) {
    std::error_code ignored;
    if (fs::remove(segment.file, ignored)) ++removed;
    fs::remove(segment.file.string() + "_el", ignored);
  }
  return removed;
}

}  // namespace topogeo::messaging
