// The kernel's files about processes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>

namespace topogeo::support {

/// The content of a file of /proc; empty if its process ends before it is read.
std::string process_file(const std::filesystem::path& file);

/// The fields of proc(5), /proc/PID/stat, after the name: the state, then numbers from the parent
/// (field 4) on. `process`: a folder of /proc, of a process or of one of its threads. Empty if it
/// has ended.
std::istringstream process_stat(const std::filesystem::path& process);

/// The start of that process in clock ticks since the boot, field 22. Process numbers are used
/// again; a number with its start names one process. Empty if the process has ended.
std::optional<std::uint64_t> process_start_ticks(const std::filesystem::path& process);

}  // namespace topogeo::support
