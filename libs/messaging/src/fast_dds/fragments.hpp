// Large samples on networks that lose packets.
#pragma once

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets what fragments.cpp puts right linked in.
void correct_fragments();

}  // namespace topogeo::messaging
