// The section `hybrid_map` of the configuration.
#pragma once

#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

void describe_hybrid_map(HybridMapConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
