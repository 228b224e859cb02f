// The services of one run as child processes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/support/cpu_time.hpp"

#include "child_process.hpp"
#include "job.hpp"

namespace topogeo::cli {

struct RunOptions {
  JobOptions job;
  std::uint32_t workers = 2;
  std::optional<std::uint32_t> wait_workers;  ///< before the first step; none: `workers`
  std::uint32_t domain = 0;
  std::string rate = "lossless";
  std::filesystem::path profiles_file;  ///< empty: built in
};

class ServiceGroup {
 public:
  /// Starts all services in the given partition; their output goes to OUT/logs/<name>.log. Throws
  /// std::runtime_error when one cannot be started, with those before it ended.
  ServiceGroup(const RunOptions& options, const std::string& partition);

  struct Death {
    std::string name;
    std::string what;  ///< "localizer was killed by signal 9 (Killed); last line of its log: ..."
    bool is_worker = false;
  };
  /// A service that has ended since the last call.
  std::optional<Death> next_death();

  /// To all of them, or to the one of that name.
  void send_signal(int signal_number, const std::string& name = {});
  /// Names of those that still run.
  [[nodiscard]] std::vector<std::string> running();

  /// Waits for all of them. Wall and CPU time of each, in the order of the stages of the work.
  std::vector<support::StageTime> wait();

 private:
  void start(const std::string& name, const std::string& program,
             const std::vector<std::string>& arguments);

  std::filesystem::path programs_;
  std::filesystem::path logs_;
  std::vector<ChildProcess> children_;
  std::vector<bool> told_;  // that it has ended, by child
};

}  // namespace topogeo::cli
