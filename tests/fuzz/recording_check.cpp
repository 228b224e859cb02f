#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "topogeo/recording/log_reader.hpp"
#include "topogeo/recording/message_source.hpp"

#include "checks.hpp"
#include "memory_file.hpp"

namespace topogeo::fuzz {
namespace {

constexpr std::size_t kMostMessages = 10'000;

/// A temporary file with a name, because SQLite opens no other.
class NamedFile {
 public:
  explicit NamedFile(std::string_view content)
      : path_(std::filesystem::temp_directory_path() /
              ("topogeo_fuzz_" + std::to_string(getpid()))) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~NamedFile() { std::filesystem::remove(path_); }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::size_t count_messages(const std::filesystem::path& file) {
  try {
    const auto source =
        recording::open_messages(file, [](const recording::Topic&) { return true; });
    recording::RawMessage message;
    std::size_t messages = 0;
    while (messages < kMostMessages && source->next(message)) {
      ++messages;
      require(message.topic < source->topics().size(), "a message is of a topic that was met");
      require(source->fraction_read() >= 0.0 && source->fraction_read() <= 1.0,
              "a share lies in [0, 1]");
    }
    require(messages == kMostMessages || !source->next(message), "the end stays the end");
    return messages;
  } catch (const std::runtime_error&) {
    return 0;
  }
}

void read_as_log(const std::filesystem::path& file) {
  try {
    recording::LogReader reader(file);
    std::optional<std::int64_t> last_ns;
    std::uint64_t scans = 0;
    while (const std::optional<scan::Scan> scan = reader.next()) {
      require(scan->sequence == scans++, "scans are numbered without gaps");
      require(!last_ns || scan->stamp_ns > *last_ns, "stamps increase");
      last_ns = scan->stamp_ns;
      require(
          scan->ranges_m.size() >= 2 && scan->ranges_m.size() <= scan::CarmenLogReader::kMaxBeams,
          "a scan has 2 to 2048 beams");
      require(scan->angle_step_rad > 0.0, "beams go counter-clockwise");
      for (const float range_m : scan->ranges_m) {
        require(std::isfinite(range_m) && range_m >= 0.0F, "a range is finite and not negative");
      }
      require(std::isfinite(scan->T_odom_robot.x_m) && std::isfinite(scan->T_odom_robot.y_m) &&
                  std::isfinite(scan->T_odom_robot.theta_rad),
              "a pose is finite");
      if (scans == kMostMessages) break;
    }
    require(scans > 0, "a log that opens has a scan");
  } catch (const std::runtime_error&) {
    return;
  }
}

}  // namespace

std::size_t check_recording(std::string_view bytes) {
  const auto check = [](const std::filesystem::path& file) {
    const std::size_t messages = count_messages(file);
    // check_carmen_log() covers all other files, which are read as CARMEN logs.
    if (recording::is_recording(file)) read_as_log(file);
    return messages;
  };
  return bytes.starts_with("SQLite") ? check(NamedFile(bytes).path())
                                     : check(MemoryFile(bytes).path());
}

}  // namespace topogeo::fuzz
