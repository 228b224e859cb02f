// Checks what comes in before Fast DDS 2.9.1 parses it. Found in its parser, each by one packet:
// 1. A partition's length is not compared with the packet, so a text is read at any address
//    (QosPoliciesSerializer<PartitionQosPolicy>): a segmentation fault.
// 2. As many data representations or domains of data sharing are stored as a count says, up to four
//    thousand million, though the packet ended long ago: memory until the process is killed.
// 3. The counts of properties and tokens, also in the handshake of strangers, are allocated as they
//    stand (CDRMessage::readPropertySeq, readOctetVector).
// 4. A NACK_FRAG of fragment 0 makes a writer send what lies before its sample.
// Each function here takes the place of one of the library, which calls it through its symbol.
// Should a library have no such function, nothing calls the one here.
#include "packet_shield.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/data/ReaderProxyData.h>
#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/common/CacheChange.h>
#include <fastdds/rtps/common/Locator.h>

#include "topogeo/messaging/topics.hpp"

#include "../packets/packet_check.hpp"
#include "../packets/parameter_check.hpp"
#include "../stranger_counts.hpp"
#include "discovery_shield.hpp"
#include "library_function.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kProcessPacket =
    "_ZN8eprosima8fastrtps4rtps15MessageReceiver13processCDRMsgERKNS1_9Locator_tES5_"
    "PNS1_12CDRMessage_tE";
constexpr const char* kReadParticipant =
    "_ZN8eprosima8fastrtps4rtps20ParticipantProxyData18readFromCDRMessageEPNS1_"
    "12CDRMessage_tEbRKNS1_14NetworkFactoryEb";
constexpr const char* kReadWriter =
    "_ZN8eprosima8fastrtps4rtps15WriterProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb";
constexpr const char* kReadReader =
    "_ZN8eprosima8fastrtps4rtps15ReaderProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb";
constexpr const char* kTakeHandshake =
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager37process_participant_stateless_"
    "messageEPKNS1_13CacheChange_tE";

thread_local bool t_unprotected = false;

/// Marks what this thread works on.
class PacketScope {
 public:
  explicit PacketScope(bool unprotected) { t_unprotected = unprotected; }
  PacketScope(const PacketScope&) = delete;
  PacketScope& operator=(const PacketScope&) = delete;
  ~PacketScope() { t_unprotected = false; }
};

bool parameters_valid(const rtps::CDRMessage_t& message) {
  if (messaging::check_parameters({message.buffer, message.length})) return true;
  messaging::count_invalid_packet();
  return false;
}

/// Of a reader or a writer that a peer announces.
bool endpoint_valid(const rtps::CDRMessage_t& message) {
  if (!parameters_valid(message)) return false;
  const std::string_view topic = messaging::topic_of({message.buffer, message.length});
  const auto topics = messaging::all_topics();
  if (std::ranges::none_of(topics, [&](const auto* known) { return known->name == topic; })) {
    messaging::count_unknown_topic();
  }
  return true;
}

/// Reads what a peer announces about a reader or a writer.
template <class Data>
bool read_endpoint(const char* symbol, Data* endpoint, rtps::CDRMessage_t* message,
                   const void* network, bool shared_memory) {
  using Function = bool (*)(Data*, rtps::CDRMessage_t*, const void*, bool);
  static const auto original = messaging::library_function<Function>(symbol);
  return endpoint_valid(*message) && original(endpoint, message, network, shared_memory) &&
         !messaging::refuse_plain_announcement(*endpoint);
}

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" void
topogeo_process_packet(void* receiver, const rtps::Locator_t& source, const rtps::Locator_t& reception, rtps::CDRMessage_t* packet) __asm__(
    "_ZN8eprosima8fastrtps4rtps15MessageReceiver13processCDRMsgERKNS1_9Locator_tES5_"
    "PNS1_12CDRMessage_tE");
extern "C" bool
topogeo_read_participant(rtps::ParticipantProxyData* data, rtps::CDRMessage_t* message, bool encapsulated, const void* network, bool shared_memory) __asm__(
    "_ZN8eprosima8fastrtps4rtps20ParticipantProxyData18readFromCDRMessageEPNS1_"
    "12CDRMessage_tEbRKNS1_14NetworkFactoryEb");
extern "C" bool
topogeo_read_writer(rtps::WriterProxyData* data, rtps::CDRMessage_t* message, const void* network, bool shared_memory) __asm__(
    "_ZN8eprosima8fastrtps4rtps15WriterProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb");
extern "C" bool
topogeo_read_reader(rtps::ReaderProxyData* data, rtps::CDRMessage_t* message, const void* network, bool shared_memory) __asm__(
    "_ZN8eprosima8fastrtps4rtps15ReaderProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb");
extern "C" void topogeo_take_handshake(void* manager, const rtps::CacheChange_t* change) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager37process_participant_stateless_"
    "messageEPKNS1_13CacheChange_tE");
// NOLINTEND

extern "C" void topogeo_process_packet(void* receiver, const rtps::Locator_t& source,
                                       const rtps::Locator_t& reception,
                                       rtps::CDRMessage_t* packet) {
  using Function =
      void (*)(void*, const rtps::Locator_t&, const rtps::Locator_t&, rtps::CDRMessage_t*);
  static const auto original = messaging::library_function<Function>(kProcessPacket);
  const messaging::PacketCheck check = messaging::check_packet({packet->buffer, packet->length});
  if (!check.valid) {
    messaging::count_invalid_packet();
    return;
  }
  const PacketScope scope(check.unprotected);
  original(receiver, source, reception, packet);
}

extern "C" bool topogeo_read_participant(rtps::ParticipantProxyData* data,
                                         rtps::CDRMessage_t* message, bool encapsulated,
                                         const void* network, bool shared_memory) {
  using Function =
      bool (*)(rtps::ParticipantProxyData*, rtps::CDRMessage_t*, bool, const void*, bool);
  static const auto original = messaging::library_function<Function>(kReadParticipant);
  if (!parameters_valid(*message) ||
      !original(data, message, encapsulated, network, shared_memory)) {
    return false;
  }
  data->m_leaseDuration = messaging::bounded_lease(data->m_leaseDuration);
  return true;
}

extern "C" bool topogeo_read_writer(rtps::WriterProxyData* data, rtps::CDRMessage_t* message,
                                    const void* network, bool shared_memory) {
  return read_endpoint(kReadWriter, data, message, network, shared_memory);
}

extern "C" bool topogeo_read_reader(rtps::ReaderProxyData* data, rtps::CDRMessage_t* message,
                                    const void* network, bool shared_memory) {
  return read_endpoint(kReadReader, data, message, network, shared_memory);
}

extern "C" void topogeo_take_handshake(void* manager, const rtps::CacheChange_t* change) {
  using Function = void (*)(void*, const rtps::CacheChange_t*);
  static const auto original = messaging::library_function<Function>(kTakeHandshake);
  const rtps::SerializedPayload_t& payload = change->serializedPayload;
  if (!messaging::check_handshake({payload.data, payload.length})) {
    messaging::count_invalid_packet();
    return;
  }
  original(manager, change);
}

namespace topogeo::messaging {

void shield_packets() {}

bool in_unprotected_packet() {
  return t_unprotected;
}

}  // namespace topogeo::messaging
