// Converts messages of the hub's channels for Foxglove: drawn objects become scene entities,
// events become a log.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/channel_hub.hpp"

namespace topogeo::web {

/// `update`: a whole message of `channel` from the hub. Returns one foxglove.SceneUpdate, or for
/// Channel::kEvents a foxglove.Log per event, in order. An entity's id is its key in the table.
/// `now_ns` stamps objects without a time of their own. Throws std::invalid_argument for a channel
/// without a topic.
std::vector<std::string> foxglove_messages(Channel channel, std::string_view update,
                                           std::int64_t now_ns);

}  // namespace topogeo::web
