// The floor of the demo, compiled in: tests/data/floor.world.yaml.
#pragma once

namespace topogeo::cli {

extern const char* const kDemoWorld;

}  // namespace topogeo::cli
