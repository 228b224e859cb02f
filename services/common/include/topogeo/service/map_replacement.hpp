// Whether the map store has put another map in the place of its own: a snapshot was restored.
//
// What a service has made of the map of before does not fit any more. A map store that restores
// disposes its StoredMap before it ends; one that only ends does not.
#pragma once

#include <functional>

#include "topogeo/service/service.hpp"

namespace topogeo::service {

/// Calls `on_replaced` in the loop of the service when the map of its robot, or of one that shares
/// it, or of Setup::options.map_robot, is replaced.
void when_map_is_replaced(Service& service, std::function<void()> on_replaced);

/// Runs the service. True when it has ended because its map was replaced: it is to begin anew with
/// what the map store has then.
bool run_with_one_map(Service& service);

}  // namespace topogeo::service
