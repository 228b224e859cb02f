// Memory of this process, MB.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

namespace topogeo::bench {

/// Value in MB of a line of /proc/self/status that is in kB; 0 if the line is missing.
inline double memory_of_status_mb(std::string_view name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name)) return std::stod(line.substr(name.size())) / 1024.0;
  }
  return 0.0;
}

inline double memory_now_mb() {
  return memory_of_status_mb("VmRSS:");
}
inline double largest_memory_mb() {
  return memory_of_status_mb("VmHWM:");
}

}  // namespace topogeo::bench
