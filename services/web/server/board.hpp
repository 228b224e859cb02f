// The former name of ChannelHub, for the senders of orders by hand.
#pragma once

#include "server/channel_hub.hpp"

namespace topogeo::web {

using Board = ChannelHub;

}  // namespace topogeo::web
