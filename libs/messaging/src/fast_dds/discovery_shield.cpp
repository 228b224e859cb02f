// Fast DDS 2.9.1 believes whatever packet says that a peer has left (CVE-2023-50257), or that one
// of its readers or writers has: with security, too, where four forged packets cut a link for good,
// because the other side still takes both for authenticated. So
// 1. a participant ends when it has been silent for its lease. A message that says so, which is
//    plain always, changes nothing: one that leaves has removed its readers and writers before;
// 2. the lease of a participant is bounded, as its announcements are plain always;
// 3. a reader or a writer that security announces encrypted is announced, changed and removed by
//    encrypted messages alone.
// Clients of a discovery server believe the server, as nobody else reports who has left.
//
// Each function here takes the place of one of the library, which calls it through its symbol.
// Should a library have no such function, nothing calls the one here.
#include "discovery_shield.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>

#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/builtin/data/ReaderProxyData.h>
#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/security/accesscontrol/EndpointSecurityAttributes.h>
#include <fastdds/rtps/security/accesscontrol/ParticipantSecurityAttributes.h>

#include "../packets/removal_log.hpp"
#include "../stranger_counts.hpp"
#include "library_function.hpp"
#include "packet_shield.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;

using RemovalReason = rtps::ParticipantDiscoveryInfo::DISCOVERY_STATUS;
using SetReader =
    std::function<bool(rtps::ReaderProxyData*, bool, const rtps::ParticipantProxyData&)>;
using SetWriter =
    std::function<bool(rtps::WriterProxyData*, bool, const rtps::ParticipantProxyData&)>;

constexpr const char* kRemoveParticipant =
    "_ZN8eprosima8fastrtps4rtps3PDP25remove_remote_participantERKNS1_6GUID_tENS1_"
    "24ParticipantDiscoveryInfo16DISCOVERY_STATUSE";
constexpr const char* kHearParticipant =
    "_ZN8eprosima8fastrtps4rtps3PDP36assert_remote_participant_livelinessERKNS1_12GuidPrefix_tE";
constexpr const char* kAddReaderData =
    "_ZN8eprosima8fastrtps4rtps3PDP18addReaderProxyDataERKNS1_6GUID_tERS3_St8functionIFbPNS1_"
    "15ReaderProxyDataEbRKNS1_20ParticipantProxyDataEEE";
constexpr const char* kAddWriterData =
    "_ZN8eprosima8fastrtps4rtps3PDP18addWriterProxyDataERKNS1_6GUID_tERS3_St8functionIFbPNS1_"
    "15WriterProxyDataEbRKNS1_20ParticipantProxyDataEEE";
constexpr const char* kRemoveReaderData =
    "_ZN8eprosima8fastrtps4rtps3PDP21removeReaderProxyDataERKNS1_6GUID_tE";
constexpr const char* kRemoveWriterData =
    "_ZN8eprosima8fastrtps4rtps3PDP21removeWriterProxyDataERKNS1_6GUID_tE";

constexpr std::int32_t kShortestLease_s = 10;
constexpr std::int32_t kLongestLease_s = 120;

/// The log of all participants of this process. Never destroyed: the threads of the middleware may
/// outlive static objects.
messaging::RemovalLog& removals() {
  static auto* const log = new messaging::RemovalLog;  // NOLINT(cppcoreguidelines-owning-memory)
  return *log;
}

messaging::RemovalLog::Peer peer_of(const rtps::GuidPrefix_t& prefix) {
  messaging::RemovalLog::Peer peer{};
  std::copy_n(prefix.value, peer.size(), peer.begin());
  return peer;
}

/// Whether a plain packet is about an endpoint that is known, where security encrypts announcements
/// (governance: discovery_protection_kind); counts it. A topic that is announced plain there has to
/// wait for the lease of its participant.
bool refuse_plain(rtps::PDP& discovery, bool (rtps::PDP::*knows)(const rtps::GUID_t&),
                  const rtps::GUID_t& endpoint) {
  if (!messaging::in_unprotected_packet()) return false;
  const auto mask = discovery.getLocalParticipantProxyData()->security_attributes_;
  const bool encrypts = rtps::security::ParticipantSecurityAttributes(mask).is_discovery_protected;
  if (!encrypts || !(discovery.*knows)(endpoint)) return false;
  messaging::count_unprotected_packet();
  return true;
}

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" bool
topogeo_remove_participant(rtps::PDP* discovery, const rtps::GUID_t& participant, RemovalReason reason) __asm__(
    "_ZN8eprosima8fastrtps4rtps3PDP25remove_remote_participantERKNS1_6GUID_tENS1_"
    "24ParticipantDiscoveryInfo16DISCOVERY_STATUSE");
extern "C" void
topogeo_hear_participant(rtps::PDP* discovery, const rtps::GuidPrefix_t& participant) __asm__(
    "_ZN8eprosima8fastrtps4rtps3PDP36assert_remote_participant_livelinessERKNS1_12GuidPrefix_tE");
extern "C" rtps::ReaderProxyData*
topogeo_add_reader_data(rtps::PDP* discovery, const rtps::GUID_t& reader, rtps::GUID_t& participant, SetReader set) __asm__(
    "_ZN8eprosima8fastrtps4rtps3PDP18addReaderProxyDataERKNS1_6GUID_tERS3_St8functionIFbPNS1_"
    "15ReaderProxyDataEbRKNS1_20ParticipantProxyDataEEE");
extern "C" rtps::WriterProxyData*
topogeo_add_writer_data(rtps::PDP* discovery, const rtps::GUID_t& writer, rtps::GUID_t& participant, SetWriter set) __asm__(
    "_ZN8eprosima8fastrtps4rtps3PDP18addWriterProxyDataERKNS1_6GUID_tERS3_St8functionIFbPNS1_"
    "15WriterProxyDataEbRKNS1_20ParticipantProxyDataEEE");
extern "C" bool
topogeo_remove_reader_data(rtps::PDP* discovery, const rtps::GUID_t& reader) __asm__(
    "_ZN8eprosima8fastrtps4rtps3PDP21removeReaderProxyDataERKNS1_6GUID_tE");
extern "C" bool
topogeo_remove_writer_data(rtps::PDP* discovery, const rtps::GUID_t& writer) __asm__(
    "_ZN8eprosima8fastrtps4rtps3PDP21removeWriterProxyDataERKNS1_6GUID_tE");
// NOLINTEND

extern "C" bool topogeo_remove_participant(rtps::PDP* discovery, const rtps::GUID_t& participant,
                                           RemovalReason reason) {
  using Function = bool (*)(rtps::PDP*, const rtps::GUID_t&, RemovalReason);
  static const auto original = messaging::library_function<Function>(kRemoveParticipant);
  const bool by_message = reason == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT;
  const bool own = participant == discovery->getLocalParticipantProxyData()->m_guid;
  if (by_message && !own &&
      discovery->builtin_attributes().discovery_config.discoveryProtocol ==
          rtps::DiscoveryProtocol_t::SIMPLE) {
    removals().removed(peer_of(participant.guidPrefix), std::chrono::steady_clock::now());
    return false;
  }
  removals().ended(peer_of(participant.guidPrefix));
  return original(discovery, participant, reason);
}

// Called for each packet.
extern "C" void topogeo_hear_participant(rtps::PDP* discovery,
                                         const rtps::GuidPrefix_t& participant) {
  using Function = void (*)(rtps::PDP*, const rtps::GuidPrefix_t&);
  static const auto original = messaging::library_function<Function>(kHearParticipant);
  original(discovery, participant);
  messaging::count_forged_removals(
      removals().heard(peer_of(participant), std::chrono::steady_clock::now()));
}

extern "C" rtps::ReaderProxyData* topogeo_add_reader_data(rtps::PDP* discovery,
                                                          const rtps::GUID_t& reader,
                                                          rtps::GUID_t& participant,
                                                          SetReader set) {
  using Function =
      rtps::ReaderProxyData* (*)(rtps::PDP*, const rtps::GUID_t&, rtps::GUID_t&, SetReader);
  static const auto original = messaging::library_function<Function>(kAddReaderData);
  if (refuse_plain(*discovery, &rtps::PDP::has_reader_proxy_data, reader)) return nullptr;
  return original(discovery, reader, participant, std::move(set));
}

extern "C" rtps::WriterProxyData* topogeo_add_writer_data(rtps::PDP* discovery,
                                                          const rtps::GUID_t& writer,
                                                          rtps::GUID_t& participant,
                                                          SetWriter set) {
  using Function =
      rtps::WriterProxyData* (*)(rtps::PDP*, const rtps::GUID_t&, rtps::GUID_t&, SetWriter);
  static const auto original = messaging::library_function<Function>(kAddWriterData);
  if (refuse_plain(*discovery, &rtps::PDP::has_writer_proxy_data, writer)) return nullptr;
  return original(discovery, writer, participant, std::move(set));
}

extern "C" bool topogeo_remove_reader_data(rtps::PDP* discovery, const rtps::GUID_t& reader) {
  using Function = bool (*)(rtps::PDP*, const rtps::GUID_t&);
  static const auto original = messaging::library_function<Function>(kRemoveReaderData);
  return !refuse_plain(*discovery, &rtps::PDP::has_reader_proxy_data, reader) &&
         original(discovery, reader);
}

extern "C" bool topogeo_remove_writer_data(rtps::PDP* discovery, const rtps::GUID_t& writer) {
  using Function = bool (*)(rtps::PDP*, const rtps::GUID_t&);
  static const auto original = messaging::library_function<Function>(kRemoveWriterData);
  return !refuse_plain(*discovery, &rtps::PDP::has_writer_proxy_data, writer) &&
         original(discovery, writer);
}

namespace topogeo::messaging {

void shield_discovery() {}

eprosima::fastrtps::Duration_t bounded_lease(const eprosima::fastrtps::Duration_t& announced) {
  const eprosima::fastrtps::Duration_t shortest(kShortestLease_s, 0);
  const eprosima::fastrtps::Duration_t longest(kLongestLease_s, 0);
  return std::clamp(announced, shortest, longest);
}

template <class Data>
bool refuse_plain_announcement(const Data& endpoint) {
  const rtps::security::EndpointSecurityAttributes attributes(endpoint.security_attributes_);
  if (!in_unprotected_packet() || !attributes.is_discovery_protected) return false;
  count_unprotected_packet();
  return true;
}

template bool refuse_plain_announcement(const rtps::ReaderProxyData& endpoint);
template bool refuse_plain_announcement(const rtps::WriterProxyData& endpoint);

}  // namespace topogeo::messaging
