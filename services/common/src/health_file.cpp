#include "topogeo/service/health_file.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include "topogeo/support/log.hpp"
#include "topogeo/support/process_stat.hpp"

namespace topogeo::service {

namespace {

constexpr std::chrono::seconds kPeriod{1};

/// The start of the process that wrote the file; empty if the file does not give it.
std::optional<std::uint64_t> start_in(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::string state;
  std::uint64_t ticks = 0;
  if (!std::getline(file, state) || !(file >> ticks)) return std::nullopt;
  return ticks;
}

/// Whether this is a file of the service, and its process has died.
bool is_of_the_dead(const std::filesystem::path& path, const std::string& service) {
  const std::string file = path.filename().string();
  std::string_view name = file;
  if (!name.starts_with(service + ".")) return false;
  name.remove_prefix(service.size() + 1);
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  if (error != std::errc() || end != name.data() + name.size() || process <= 0) return false;
  if (::kill(process, 0) != 0 && errno == ESRCH) return true;
  const auto written = start_in(path);
  const auto running = support::process_start_ticks("/proc/" + std::to_string(process));
  return written && running && *written != *running;
}

void remove_those_of_the_dead(const std::filesystem::path& folder, const std::string& service) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (is_of_the_dead(entry.path(), service)) {
      std::filesystem::remove(entry.path(), ignored);
    }
  }
}

}  // namespace

std::filesystem::path HealthFile::folder() {
  const char* const given =
      std::getenv("TOPOGEO_HEALTH");  // NOLINT(concurrency-mt-unsafe): never set here
  return given == nullptr ? "" : given;
}

HealthFile::HealthFile(const std::filesystem::path& folder, const std::string& service) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    log_failure(folder.string() + ": " + error.message());
  } else {
    remove_those_of_the_dead(folder, service);
  }
  if (const auto ticks = support::process_start_ticks("/proc/self")) {
    start_ = std::to_string(*ticks);
  }
  const std::string name = service + "." + std::to_string(::getpid());
  draft_ = folder / ("." + name);
  file_ = folder / name;
}

HealthFile::~HealthFile() {
  if (file_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  std::filesystem::remove(draft_, ignored);
}

void HealthFile::update(const std::string& text) {
  const auto now = Clock::now();
  if (file_.empty() || (text == text_ && now - written_ < kPeriod)) return;
  text_ = text;
  written_ = now;
  // Not by write_file_atomically, which waits for the disk: this loop may be that of the guard.
  std::ofstream draft(draft_, std::ios::binary);
  std::string state = text;
  std::ranges::replace(state, '\n', ' ');  // an error message may have several lines
  draft << state << '\n' << start_ << '\n';
  draft.close();
  if (!draft) {
    log_failure(draft_.string() + ": cannot be written");
    return;
  }
  std::error_code error;
  std::filesystem::rename(draft_, file_, error);
  if (error) {
    log_failure(file_.string() + ": " + error.message());
    return;
  }
  works_ = true;
}

void HealthFile::log_failure(const std::string& reason) {
  if (works_) spdlog::warn("health file: {}; health checks of this service fail", reason);
  works_ = false;
}

}  // namespace topogeo::service
