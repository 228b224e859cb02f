// The services of this project that run as processes on this host. These include services that
// discovery does not find, for example because a signal or a debugger has stopped them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace topogeo::cli {

struct HostProcess {
  pid_t pid = 0;
  pid_t own_pid = 0;         ///< in its own PID namespace, as its status gives it: in a container
                             ///< it differs from `pid`
  std::string service;       ///< "localizer"
  std::uint32_t domain = 0;  ///< from its command line, else from its environment if readable
  std::string partition;     ///< from its command line, else the default
  bool stopped = false;      ///< whether a signal or a debugger has stopped it
  double age_s = 0.0;        ///< since its start
  std::string robot{};       ///< from its command line, else its environment; may be empty
};

/// The services with the network and the host name of this process, by pid; none without `proc`. A
/// process of another user counts as one of them.
std::vector<HostProcess> host_processes(const std::filesystem::path& proc = "/proc");

}  // namespace topogeo::cli
