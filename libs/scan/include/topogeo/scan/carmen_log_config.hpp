// How a CARMEN log is read.
#pragma once

namespace topogeo::scan {

struct CarmenLogOptions {
  double range_max_m = 49.9;  ///< readings at or above it become Scan::kNoReturn; > 0
  /// A stamp further than this after its predecessor (or the very first one) must be confirmed by
  /// the next scan; otherwise it, and not the rest of the log, is taken to be wrong. Seconds, > 0.
  double jump_s = 60.0;
};

}  // namespace topogeo::scan
