// The part of the configuration that is about driving.
#pragma once

#include "topogeo/navigation/navigator.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

/// Declares the sections navigator and guard.
void describe_navigator(navigation::NavigatorConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
