// The machine that the program runs on, for display and for names.
#pragma once

#include <cstdint>
#include <string>

namespace topogeo::support {

/// 1 to 64 bytes; "unknown" when the system does not provide it.
std::string host_name();

/// "<host>-<process id>", 40 bytes at most: who this process is, to people and to other processes.
std::string process_name();

/// Since 1970. For display only: no result may depend on it.
std::int64_t wall_clock_ns();

}  // namespace topogeo::support
