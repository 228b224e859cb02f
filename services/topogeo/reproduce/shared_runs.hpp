// Results that several experiments look at, each made once, when it is first asked for.
#pragma once

namespace topogeo::reproduce {

class SharedRuns {};

}  // namespace topogeo::reproduce
