// The floor of the demo, compiled in: share/worlds/floor.world.yaml.
#pragma once

namespace topogeo::cli {

extern const char* const kDemoWorld;

}  // namespace topogeo::cli
