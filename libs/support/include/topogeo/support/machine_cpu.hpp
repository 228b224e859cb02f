// The CPU time that a machine or a control group has, and how much it is asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace topogeo::support {

struct MachineCpu {
  std::uint32_t processors = 1;          ///< that this process may use
  double load = 0.0;                     ///< threads that ran or wanted to, mean of a minute
  std::optional<double> pressure_share;  ///< of the last 10 s, in which a thread waited for a CPU
  /// CPUs that the control groups of this process leave it; nothing: as many as there are.
  std::optional<double> quota;
  /// Periods of the group with that quota, since it was made.
  std::uint64_t quota_periods = 0;
  std::uint64_t throttled_periods = 0;  ///< of these, in which it was stopped

  /// CPUs that this process can have at most.
  [[nodiscard]] double available() const;
};

/// Where the kernel shows it. Tests name other places.
struct MachineCpuSources {
  std::filesystem::path proc = "/proc";
  std::filesystem::path cgroup = "/sys/fs/cgroup";
};

/// Reads control groups of version 1 and 2. A value that cannot be read is left out.
MachineCpu read_machine_cpu(const MachineCpuSources& sources = {});

/// "2 processors, a quota of 0.8 CPUs, load 7.3, a thread waits for a CPU 91 % of the time".
std::string describe(const MachineCpu& machine);

}  // namespace topogeo::support
