// The kernel's statistics of a process or a thread.
#pragma once

#include <filesystem>
#include <sstream>

namespace topogeo::support {

/// The fields of proc(5), /proc/PID/stat, after the name: the state, then numbers from the parent
/// (field 4) on. `process`: a folder of /proc, of a process or of one of its threads. Empty if it
/// has ended.
std::istringstream process_stat(const std::filesystem::path& process);

}  // namespace topogeo::support
