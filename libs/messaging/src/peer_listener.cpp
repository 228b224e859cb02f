#include "peer_listener.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#if TOPOGEO_FAST_DDS == 2
#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/common/Token.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#else
#include <fastdds/dds/builtin/topic/ParticipantBuiltinTopicData.hpp>
#include <fastdds/dds/builtin/topic/PublicationBuiltinTopicData.hpp>
#include <fastdds/dds/builtin/topic/SubscriptionBuiltinTopicData.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.hpp>
#include <fastdds/rtps/reader/ReaderDiscoveryStatus.hpp>
#include <fastdds/rtps/writer/WriterDiscoveryStatus.hpp>
#endif

#include "topogeo/messaging/topics.hpp"

#include "endpoint_shared.hpp"
#include "packets/packet_filter.hpp"
#include "packets/proven_peers.hpp"
#include "stranger_counts.hpp"

namespace topogeo::messaging {

namespace dds = eprosima::fastdds::dds;

namespace {

double seconds_of(const DdsDuration& duration) {
  constexpr double kNanosecond_s = 1e-9;
  if (is_infinite(duration)) return 0.0;
  return static_cast<double>(duration.seconds) + kNanosecond_s * duration.nanosec;
}

/// The policies of a reader or a writer, which each version has in types of its own.
struct Policies {
  const dds::ReliabilityQosPolicy& reliability;
  const dds::DurabilityQosPolicy& durability;
  const dds::DeadlineQosPolicy& deadline;
  const dds::LivelinessQosPolicy& liveliness;
  const dds::OwnershipQosPolicy& ownership;
};

OfferedQos to_qos(const Policies& policies) {
  OfferedQos qos;
  qos.reliable = policies.reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  qos.durability = static_cast<std::uint32_t>(policies.durability.kind);
  qos.deadline_s = seconds_of(policies.deadline.period);
  qos.liveliness = static_cast<std::uint32_t>(policies.liveliness.kind);
  qos.lease_s = seconds_of(policies.liveliness.lease_duration);
  qos.exclusive = policies.ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS;
  return qos;
}

#if TOPOGEO_FAST_DDS == 2

template <class Data>
DiscoveredEndpoint to_endpoint(const Data& data, bool writer, bool gone) {
  const auto& qos = data.m_qos;
  DiscoveredEndpoint found;
  found.id = data.guid();
  found.gone = gone;
  found.user_data = qos.m_userData.data_vec();
  found.endpoint.id = detail::to_handle(rtps::InstanceHandle_t(data.guid()));
  found.endpoint.topic = data.topicName().to_string();
  found.endpoint.type = data.typeName().to_string();
  found.endpoint.writer = writer;
  found.endpoint.partitions = qos.m_partition.names();
  found.endpoint.qos = to_qos(
      {qos.m_reliability, qos.m_durability, qos.m_deadline, qos.m_liveliness, qos.m_ownership});
  return found;
}

std::string announced_subject(const rtps::ParticipantProxyData& peer) {
  const std::string* const subject =
      rtps::DataHolderHelper::find_property_value(peer.identity_token_, "dds.cert.sn");
  return subject == nullptr ? std::string() : *subject;
}

#else

template <class Data>
DiscoveredEndpoint to_endpoint(const Data& data, bool writer, bool gone) {
  DiscoveredEndpoint found;
  found.id = data.guid;
  found.gone = gone;
  found.user_data = data.user_data.data_vec();
  found.endpoint.id = detail::to_handle(rtps::InstanceHandle_t(data.guid));
  found.endpoint.topic = data.topic_name.to_string();
  found.endpoint.type = data.type_name.to_string();
  found.endpoint.writer = writer;
  found.endpoint.partitions = data.partition.names();
  found.endpoint.qos =
      to_qos({data.reliability, data.durability, data.deadline, data.liveliness, data.ownership});
  return found;
}

#endif

PeerPrefix prefix_of(const rtps::GUID_t& id) {
  PeerPrefix prefix{};
  std::copy_n(id.guidPrefix.value, prefix.size(), prefix.begin());
  return prefix;
}

}  // namespace

#if TOPOGEO_FAST_DDS == 2

void PeerListener::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                            rtps::ParticipantDiscoveryInfo&& info) {
  tell({info.info.m_guid, info.info.m_participantName.to_string(), announced_subject(info.info),
        info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
            info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT});
}

void PeerListener::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                          rtps::WriterDiscoveryInfo&& info) {
  tell(to_endpoint(info.info, true, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER));
}

void PeerListener::on_subscriber_discovery(dds::DomainParticipant* /*participant*/,
                                           rtps::ReaderDiscoveryInfo&& info) {
  tell(to_endpoint(info.info, false, info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER));
}

#else

void PeerListener::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                            rtps::ParticipantDiscoveryStatus status,
                                            const dds::ParticipantBuiltinTopicData& info,
                                            bool& should_be_ignored) {
  should_be_ignored = false;
  tell({info.guid, info.participant_name.to_string(), "",
        status == rtps::ParticipantDiscoveryStatus::REMOVED_PARTICIPANT ||
            status == rtps::ParticipantDiscoveryStatus::DROPPED_PARTICIPANT});
}

void PeerListener::on_data_writer_discovery(dds::DomainParticipant* /*participant*/,
                                            rtps::WriterDiscoveryStatus status,
                                            const dds::PublicationBuiltinTopicData& info,
                                            bool& should_be_ignored) {
  should_be_ignored = false;
  tell(to_endpoint(info, true, status == rtps::WriterDiscoveryStatus::REMOVED_WRITER));
}

void PeerListener::on_data_reader_discovery(dds::DomainParticipant* /*participant*/,
                                            rtps::ReaderDiscoveryStatus status,
                                            const dds::SubscriptionBuiltinTopicData& info,
                                            bool& should_be_ignored) {
  should_be_ignored = false;
  tell(to_endpoint(info, false, status == rtps::ReaderDiscoveryStatus::REMOVED_READER));
}

#endif

void PeerListener::onParticipantAuthentication(dds::DomainParticipant* /*participant*/,
                                               rtps::ParticipantAuthenticationInfo&& info) {
  const bool authorized =
      info.status == rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT;
  if (authorized) proven_peers().add(prefix_of(info.guid));
  on_authentication(info.guid.guidPrefix, authorized);
}

void PeerListener::tell(const DiscoveredPeer& peer) {
  if (peer.gone) peer_ended(prefix_of(peer.id));
  on_peer(peer);
}

void PeerListener::tell(const DiscoveredEndpoint& endpoint) {
  const auto is_topic = [&](const TopicInfo* topic) {
    return topic->name == endpoint.endpoint.topic;
  };
  if (!endpoint.gone && std::ranges::none_of(all_topics(), is_topic)) count_unknown_topic();
  on_peer_endpoint(endpoint);
}

}  // namespace topogeo::messaging
