// Effort and tolerance of a search for consistent poses along a loop.
#pragma once

#include <cstdint>

namespace topogeo::localization {

struct LoopSearchConfig {
  std::uint32_t beam_width = 60;  ///< paths that advance together; a wider beam finds better ones
                                  ///< at a proportional cost (benchmark backward/60)
  std::uint32_t waiting = 120;    ///< paths kept at each pose for backtracking
  std::uint64_t largest_work = 400'000;  ///< steps tried in all; bounds the work on a hopeless loop
  double probability = 0.99;  ///< of the ellipse whose rectangle must contain a pose: all poses of
                              ///< a loop must be inside, so 95 % each would refuse many right loops
  double heading_sigmas = 3.0;
  double resolution_m = 0.15;           ///< resolution of the genetic search:
  double resolution_rad = 0.034906585;  ///< the smallest half-width of an uncertainty
  bool draw = true;                     ///< also tries each pose drawn towards the expected one
  std::uint32_t paths_wanted = 3;       ///< best paths returned
  friend bool operator==(const LoopSearchConfig&, const LoopSearchConfig&) = default;
};

}  // namespace topogeo::localization
