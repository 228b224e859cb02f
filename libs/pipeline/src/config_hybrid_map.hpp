// The sections `hybrid_map` and `hybrid_planner` of the configuration.
#pragma once

#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

void describe_hybrid_map(HybridMapConfig& config, support::ConfigSchema& schema);
void describe_hybrid_planner(planning::HybridPlannerConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
