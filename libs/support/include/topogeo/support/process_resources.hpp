// System resources used by this process, for its status.
#pragma once

#include <cstdint>

namespace topogeo::support {

/// Memory in use, bytes; 0 if the system does not report it.
std::uint64_t resident_bytes();

/// Open files, sockets and the like; 0 if the system does not report them.
std::uint64_t open_files();

}  // namespace topogeo::support
