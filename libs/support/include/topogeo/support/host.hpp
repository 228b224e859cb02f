// The machine that the program runs on, for display and for names.
#pragma once

#include <cstdint>
#include <string>

namespace topogeo::support {

/// 1 to 64 bytes; "unknown" if the system does not provide it.
std::string host_name();

/// "<host>-<process id>", in a container "<host>-<process id>.<number of its PID namespace>"; at
/// most 50 bytes, of which the host keeps 31 or more. Identifies this process for users and other
/// processes.
std::string process_name();

/// Identifies the time since the machine was started: files and clocks of before do not count.
std::uint64_t this_boot();

/// Time since 1970. For display only: no result may depend on it.
std::int64_t wall_clock_ns();

/// Time of the steady clock, which never goes back, since any moment; that of all stamps of
/// arrivals.
std::int64_t monotonic_ns();

}  // namespace topogeo::support
