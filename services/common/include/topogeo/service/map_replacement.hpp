// Detects that the map store has replaced its map because a snapshot was restored.
//
// Results based on the previous map are invalid then. A map store that restores a snapshot disposes
// its StoredMap before it ends; a normal end does not dispose it.
#pragma once

#include <functional>

#include "topogeo/service/service.hpp"

namespace topogeo::service {

/// Calls `on_replaced` in the loop of the service when the map of its robot, of a robot that shares
/// it, or of Setup::options.map_robot is replaced.
void when_map_is_replaced(Service& service, std::function<void()> on_replaced);

/// Runs the service. Returns true when the service ended because its map was replaced: the caller
/// starts again with the new map of the store.
bool run_with_one_map(Service& service);

}  // namespace topogeo::service
