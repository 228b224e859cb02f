// Messages of the board's channels for Foxglove: what pages draw as entities of a scene, events as
// a log.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/board.hpp"

namespace topogeo::web {

/// `update`: a whole message of `channel`, as the board gives it. One foxglove.SceneUpdate; for
/// Channel::kEvents a foxglove.Log for each event, in their order. An entity's id is its key in the
/// table. `now_ns` stamps what has no time of its own. Throws std::invalid_argument for a channel
/// that no topic shows.
std::vector<std::string> foxglove_messages(Channel channel, std::string_view update,
                                           std::int64_t now_ns);

}  // namespace topogeo::web
