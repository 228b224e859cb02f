// The transports of a participant with our own around each: it judges each packet before the
// middleware reads it, and sends what goes to one host through a socket of its own. Everything here
// is public in Fast DDS 2.9.1 and 3.
#pragma once

#include <string>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "packet_filter.hpp"

namespace topogeo::messaging {

/// Puts ours around each transport of `qos`, after which nothing may change them. In place of
/// transports that the middleware would choose itself it names those: shared memory and UDP. Throws
/// std::runtime_error, with the name of the participant profile, for other transports than UDP and
/// shared memory.
void filter_packets(eprosima::fastdds::dds::DomainParticipantQos& qos, const std::string& profile,
                    const PacketFilter::Options& options);

}  // namespace topogeo::messaging
