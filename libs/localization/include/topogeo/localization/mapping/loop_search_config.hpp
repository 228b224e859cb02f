// How far a search for consistent poses along a loop goes.
#pragma once

#include <cstdint>

namespace topogeo::localization {

struct LoopSearchConfig {
  std::uint32_t beam_width = 60;  ///< paths that advance together; wider finds better ones, at a
                                  ///< cost in proportion (benchmark backward/60)
  std::uint32_t waiting = 120;    ///< paths kept at each pose for backtracking
  std::uint64_t largest_work = 400'000;  ///< steps tried in all, so that a hopeless loop ends too
  double probability =
      0.99;  ///< of the ellipse whose rectangle a pose must lie in: a loop needs
             ///< all its poses inside, so 95 % of each would refuse many right ones
  double heading_sigmas = 3.0;
  double resolution_m = 0.15;           ///< of the genetic search:
  double resolution_rad = 0.034906585;  ///< the least half-width of an uncertainty
  bool draw = true;  ///< tries each pose also where it comes nearer to the expected one
  std::uint32_t paths_wanted = 3;  ///< best paths returned
  friend bool operator==(const LoopSearchConfig&, const LoopSearchConfig&) = default;
};

}  // namespace topogeo::localization
