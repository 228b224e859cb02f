// MACONDO, part IV: how often simulated drives arrive.
#pragma once

#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {

/// The share of 200 drives that end within one cell of their goal, by the published rule of
/// perception and by others beside it.
void macondo_arrival(Report& report);

}  // namespace topogeo::reproduce
