// What a packet may change in what this process knows about its peers.
#pragma once

#include <fastdds/rtps/common/Time_t.h>

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets the shield linked in.
void shield_discovery();

/// The lease of a peer for one that it announces: from 10 s, the lease of all services, to 120 s.
/// A shorter one in a packet of a stranger would end the peer, a longer one would keep one that has
/// left.
[[nodiscard]] eprosima::fastrtps::Duration_t bounded_lease(
    const eprosima::fastrtps::Duration_t& announced);

/// Whether this thread works on a plain packet that announces a reader or a writer whose
/// announcement security encrypts; counts it. `Data`: ReaderProxyData or WriterProxyData.
template <class Data>
[[nodiscard]] bool refuse_plain_announcement(const Data& endpoint);

}  // namespace topogeo::messaging
