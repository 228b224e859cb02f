// The counters in the localizer's status.
#pragma once

#include <cstddef>

#include "topogeo/messaging/status_publisher.hpp"
#include "topogeo/slam/slam.hpp"

#include "remote_pool.hpp"

namespace topogeo::localizer {

/// Sets the matches and loops so far.
void set_slam_counters(const localization::Slam& slam, std::size_t loop_closures,
                       messaging::StatusPublisher& status);

/// Sets the workers, tasks and answers so far.
void set_pool_counters(const RemotePool& pool, messaging::StatusPublisher& status);

}  // namespace topogeo::localizer
