// The CPU time available to a machine or a control group, and the demand for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace topogeo::support {

struct MachineCpu {
  std::uint32_t processors = 1;          ///< that this process may use
  double load = 0.0;                     ///< threads that ran or wanted to run, mean over a minute
  std::optional<double> pressure_share;  ///< of the last 10 s, with a thread waiting for a CPU
  /// CPUs that the control groups allow this process; empty: all.
  std::optional<double> quota;
  /// Periods of the group with that quota, since its creation.
  std::uint64_t quota_periods = 0;
  std::uint64_t throttled_periods = 0;  ///< of these, in which it was stopped

  /// Upper limit of CPUs for this process.
  [[nodiscard]] double available() const;
};

/// Folders of the kernel interface. Tests use others.
struct MachineCpuSources {
  std::filesystem::path proc = "/proc";
  std::filesystem::path cgroup = "/sys/fs/cgroup";
};

/// Reads control groups of version 1 and 2. Leaves out values that cannot be read.
MachineCpu read_machine_cpu(const MachineCpuSources& sources = {});

/// "2 processors, a quota of 0.8 CPUs, load 7.3, a thread waits for a CPU 91 % of the time".
std::string describe(const MachineCpu& machine);

}  // namespace topogeo::support
