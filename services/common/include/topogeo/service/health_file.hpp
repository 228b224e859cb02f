// The state of a service in a file, for health checks that must cost little.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace topogeo::service {

/// `FOLDER/SERVICE.PID` with two lines: the state of the service and its message (the text of
/// messaging::StatusPublisher), and the start of the process (support::process_start_ticks),
/// because a later process may get the number of a dead one. The file is written anew each second,
/// so an old one shows that the service hangs. deploy/health reads it.
class HealthFile {
 public:
  /// The folder that TOPOGEO_HEALTH of the environment names; empty: no file is written.
  static std::filesystem::path folder();

  /// Makes the folder, and removes what processes of this service that have died left there. A
  /// folder that cannot be written is logged: a health check then finds no file.
  HealthFile(const std::filesystem::path& folder, const std::string& service);
  HealthFile(const HealthFile&) = delete;
  HealthFile& operator=(const HealthFile&) = delete;
  /// Removes the file.
  ~HealthFile();

  /// Writes the file if the text is new or a second has passed.
  void update(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;

  void log_failure(const std::string& reason);

  std::filesystem::path file_;
  std::filesystem::path draft_;  // renamed to file_, so that no reader sees a part of it
  std::string start_;            // of this process; empty: /proc does not give it
  std::string text_;
  Clock::time_point written_;
  bool works_ = true;
};

}  // namespace topogeo::service
