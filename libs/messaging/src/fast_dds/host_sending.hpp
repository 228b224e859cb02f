// Packets to one host do not wait for another.
#pragma once

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets what host_sending.cpp puts right linked in.
void send_to_each_host_apart();

}  // namespace topogeo::messaging
