// Large samples on networks that lose packets.
#pragma once

#include <cstdint>

#include <fastdds/rtps/common/CacheChange.h>
#include <fastdds/rtps/messages/RTPSMessageGroup.h>

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets what fragments.cpp puts right linked in.
void correct_fragments();

/// From here on this process sends each fragment of a sample in a message of its own, of at most so
/// many bytes, though a message may hold more. What the middleware says of itself still goes whole.
void send_fragments_within(std::uint32_t message_bytes);

/// Sends the group, to which a fragment of the sample was added, where fragments go alone.
void send_if_alone(eprosima::fastrtps::rtps::RTPSMessageGroup& group,
                   const eprosima::fastrtps::rtps::CacheChange_t& sample);

}  // namespace topogeo::messaging
