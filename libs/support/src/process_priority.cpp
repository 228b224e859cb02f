#include "topogeo/support/process_priority.hpp"

#include <sys/resource.h>

namespace topogeo::support {

bool go_first() {
  // The highest: it is for programs that need little time, but at the right moment.
  constexpr int kNiceness = -20;
  return ::setpriority(PRIO_PROCESS, 0, kNiceness) == 0;
}

}  // namespace topogeo::support
