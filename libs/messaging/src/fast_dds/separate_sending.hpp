// Heartbeats of addressed messages, and how often they are acknowledged.
#pragma once

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/rtps/writer/RTPSWriter.h>

namespace topogeo::messaging {

/// Lets a synchronous writer send heartbeats to those readers only that have something to
/// acknowledge. Otherwise each goes to all readers as long as one of them has: with 64 workers in
/// processes of their own, answering heartbeats about the tasks of others took four fifths of the
/// CPU time of a task. Changes nothing with a Fast DDS that does not let its writers be found.
///
/// Such a writer adds a heartbeat to each message, which asks for an acknowledgment, and sends the
/// numbers of the messages between, to others, in a packet of their own: six packets for a task and
/// its answer. Here they go with the message, and of a stream of messages most only report what was
/// sent: the reader asks at once for what it lacks, and acknowledges every 10 ms.
void send_heartbeats_to_addressees(const eprosima::fastdds::dds::DataWriter& writer);

/// Lives while this thread sends a message of `writer` for the first time.
class SendingScope {
 public:
  explicit SendingScope(const eprosima::fastrtps::rtps::RTPSWriter& writer);
  SendingScope(const SendingScope&) = delete;
  SendingScope& operator=(const SendingScope&) = delete;
  ~SendingScope();
};

}  // namespace topogeo::messaging
