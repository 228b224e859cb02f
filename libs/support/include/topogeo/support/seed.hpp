// Seeds of the parts of a run, derived from the run's own seed.
//
// A seed is derived from its use (robot, maps, pass), so it does not depend on the order of the
// work or on the worker.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace topogeo::support {

/// One step of the splitmix64 generator: a bijective mix of all 64 bits.
std::uint64_t splitmix64(std::uint64_t value);

/// Seed of the part of a run named by `robot_id` and `ids`. The order of `ids` counts.
std::uint64_t derive_seed(std::uint64_t run_seed, std::string_view robot_id,
                          std::initializer_list<std::uint64_t> ids);

}  // namespace topogeo::support
