// Reports of discovery about other participants, in the same form for both versions of Fast DDS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include "topogeo/messaging/detail/fast_dds.hpp"
#include "topogeo/messaging/discovery.hpp"

namespace topogeo::messaging {

/// Another participant.
struct DiscoveredPeer {
  rtps::GUID_t id;
  std::string name;
  std::string subject;  ///< announced for its certificate; empty without security
  bool gone = false;    ///< it left, or its lease is over
};

/// A reader or writer of another participant.
struct DiscoveredEndpoint {
  rtps::GUID_t id;
  RemoteEndpoint endpoint;  ///< without the name of the participant
  std::vector<std::uint8_t> user_data;
  bool gone = false;
};

/// Called by threads of the middleware, for all endpoints before they are connected.
class PeerListener : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  virtual void on_peer(const DiscoveredPeer& /*peer*/) {}
  virtual void on_peer_endpoint(const DiscoveredEndpoint& /*endpoint*/) {}
  /// With security: whether the peer has proven its identity.
  virtual void on_authentication(const rtps::GuidPrefix_t& /*peer*/, bool /*authorized*/) {}

#if TOPOGEO_FAST_DDS == 2
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                rtps::ParticipantDiscoveryInfo&& info) final;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              rtps::WriterDiscoveryInfo&& info) final;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                               rtps::ReaderDiscoveryInfo&& info) final;
#else
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                rtps::ParticipantDiscoveryStatus status,
                                const eprosima::fastdds::dds::ParticipantBuiltinTopicData& info,
                                bool& should_be_ignored) final;
  void on_data_writer_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                rtps::WriterDiscoveryStatus status,
                                const eprosima::fastdds::dds::PublicationBuiltinTopicData& info,
                                bool& should_be_ignored) final;
  void on_data_reader_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                rtps::ReaderDiscoveryStatus status,
                                const eprosima::fastdds::dds::SubscriptionBuiltinTopicData& info,
                                bool& should_be_ignored) final;
#endif
  void onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant* participant,
                                   rtps::ParticipantAuthenticationInfo&& info) final;

 private:
  void tell(const DiscoveredPeer& peer);
  void tell(const DiscoveredEndpoint& endpoint);
};

}  // namespace topogeo::messaging
