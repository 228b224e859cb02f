// Scheduling priority of a process.
#pragma once

namespace topogeo::support {

/// Gives this thread, and the threads and processes that it starts from now on, priority over
/// others that wait for a CPU. False if the process lacks the permission (CAP_SYS_NICE); the
/// priority is then unchanged.
bool go_first();

}  // namespace topogeo::support
