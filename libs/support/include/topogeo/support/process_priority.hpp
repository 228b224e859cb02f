// Scheduling priority of a process.
#pragma once

namespace topogeo::support {

/// Gives this process priority over others that wait for a CPU, for its lifetime. False if it lacks
/// the permission (CAP_SYS_NICE); the priority is then unchanged.
bool go_first();

}  // namespace topogeo::support
