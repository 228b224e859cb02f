// The right of way of a process on its machine.
#pragma once

namespace topogeo::support {

/// This process goes before others that wait for a CPU, for as long as it lives. False: it lacks
/// the right (CAP_SYS_NICE), and goes with the others.
bool go_first();

}  // namespace topogeo::support
