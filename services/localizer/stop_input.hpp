// Adds arriving local maps to the queue of a localizer.
#pragma once

#include "topogeo/msg/local_map.h"
#include "topogeo/service/service.hpp"

#include "stop_queue.hpp"

namespace topogeo::localizer {

/// Adds a new local map; reports one of another run or one that comes after the end (`finished`).
/// Returns false when it was not added. Throws like service::from_msg().
bool add_stop(service::Service& service, const msg::LocalMap& message, bool finished,
              StopQueue& queue);

}  // namespace topogeo::localizer
