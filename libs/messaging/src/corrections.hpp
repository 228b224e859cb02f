// Corrections of Fast DDS 2.9.1 (src/fast_dds). Fast DDS 3 has none (fast_dds_3.cpp) and therefore
// no security here.
#pragma once

#include <cstdint>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>

namespace topogeo::messaging {

/// A call links the corrections into the program, and does nothing else.
void correct_fast_dds();

/// The same for the corrections of security. Throws std::runtime_error with Fast DDS 3: the rules
/// about robots, which security needs, are corrections.
void correct_security();

/// Keeps packets within the largest message of the transports, as a participant with Fast DDS 2.9.1
/// expects it: it reads no more bytes of a packet. Fast DDS 3.1.2 by itself adds the key of a
/// sample to a fragment that fills the message.
void fit_packets(eprosima::fastdds::dds::DomainParticipantQos& qos);

/// Makes this process send each fragment of a sample in a message of its own, of at most so many
/// bytes, though a message may hold more. Messages of discovery still go whole.
void send_fragments_within(std::uint32_t message_bytes);

/// Lets a writer of addressed messages send heartbeats to the addressees alone
/// (fast_dds/separate_sending.hpp).
void send_heartbeats_to_addressees(const eprosima::fastdds::dds::DataWriter& writer);

}  // namespace topogeo::messaging
