// What the system gives this process, for its status.
#pragma once

#include <cstdint>

namespace topogeo::support {

/// Memory that is in use now; 0 where the system does not report it.
std::uint64_t resident_bytes();

/// Files, sockets and the like that are open now; 0 where the system does not report it.
std::uint64_t open_files();

}  // namespace topogeo::support
