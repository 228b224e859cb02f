// Ids of processes and of instances of the status topic, as assigned by the middleware.
#pragma once

#include <array>
#include <cstdint>

namespace topogeo::search_pool {

/// A process on the network; all zero: none.
using ProcessId = std::array<std::uint8_t, 12>;
/// An instance of a keyed topic.
using InstanceId = std::array<std::uint8_t, 16>;

}  // namespace topogeo::search_pool
