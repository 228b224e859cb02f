#include "topogeo/support/process_priority.hpp"

#include <sys/resource.h>

namespace topogeo::support {

bool go_first() {
  constexpr int kNiceness = -10;  // as in the system units of gateway and navigator
  return ::setpriority(PRIO_PROCESS, 0, kNiceness) == 0;
}

}  // namespace topogeo::support
