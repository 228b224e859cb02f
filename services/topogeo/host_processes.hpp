// The services of this project that run as processes of this host, whether or not they are heard:
// one that is stopped by a signal or a debugger answers no discovery.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace topogeo::cli {

struct HostProcess {
  pid_t pid = 0;
  std::string service;       ///< "localizer"
  std::uint32_t domain = 0;  ///< of its command line, else of its environment if it can be read
  std::string partition;     ///< of its command line, else the default
  bool stopped = false;      ///< by a signal or a debugger
  double age_s = 0.0;        ///< since it was started
};

/// The services in the network of this process, by pid; none where there is no `proc`. A process
/// of another user counts as one of this network.
std::vector<HostProcess> host_processes(const std::filesystem::path& proc = "/proc");

}  // namespace topogeo::cli
