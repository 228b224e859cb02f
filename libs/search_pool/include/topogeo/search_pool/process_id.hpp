// Names of processes and of the status topic's instances, as the middleware gives them out.
#pragma once

#include <array>
#include <cstdint>

namespace topogeo::search_pool {

/// A process on the network; all zero: none.
using ProcessId = std::array<std::uint8_t, 12>;
/// An instance of a keyed topic.
using InstanceId = std::array<std::uint8_t, 16>;

}  // namespace topogeo::search_pool
