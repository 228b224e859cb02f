// Reports about a peer, from discovery of both versions of Fast DDS.
#include "peer_listener.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#if TOPOGEO_FAST_DDS == 2
#include <fastdds/rtps/attributes/RTPSParticipantAllocationAttributes.hpp>
#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#else
#include <fastdds/dds/builtin/topic/ParticipantBuiltinTopicData.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.hpp>
#endif

namespace topogeo::messaging {
namespace {

enum class Change { kFound, kLeft, kLost };

rtps::GuidPrefix_t prefix_of_listened_peer() {
  rtps::GuidPrefix_t prefix;
  prefix.value[11] = 7;
  return prefix;
}

class Listener final : public PeerListener {
 public:
  void on_peer(const DiscoveredPeer& peer) override { peers.push_back(peer); }
  void on_authentication(const rtps::GuidPrefix_t& peer, bool authorized) override {
    authenticated.emplace_back(peer, authorized);
  }

  std::vector<DiscoveredPeer> peers;
  std::vector<std::pair<rtps::GuidPrefix_t, bool>> authenticated;
};

#if TOPOGEO_FAST_DDS == 2

void report(Listener& listener, Change change) {
  using Info = rtps::ParticipantDiscoveryInfo;
  rtps::ParticipantProxyData data{rtps::RTPSParticipantAllocationAttributes()};
  data.m_guid.guidPrefix = prefix_of_listened_peer();
  data.m_participantName = "robot/ga_worker";
  rtps::Property property;
  property.name("dds.cert.sn");
  property.value("CN=ga_worker");
  data.identity_token_.properties().push_back(property);
  Info info(data);
  info.status = change == Change::kFound  ? Info::DISCOVERED_PARTICIPANT
                : change == Change::kLeft ? Info::REMOVED_PARTICIPANT
                                          : Info::DROPPED_PARTICIPANT;
  listener.on_participant_discovery(nullptr, std::move(info));
}
constexpr const char* kSubject = "CN=ga_worker";

#else

void report(Listener& listener, Change change) {
  using Status = rtps::ParticipantDiscoveryStatus;
  eprosima::fastdds::dds::ParticipantBuiltinTopicData data;
  data.guid.guidPrefix = prefix_of_listened_peer();
  data.participant_name = "robot/ga_worker";
  bool ignored = true;
  listener.on_participant_discovery(nullptr,
                                    change == Change::kFound  ? Status::DISCOVERED_PARTICIPANT
                                    : change == Change::kLeft ? Status::REMOVED_PARTICIPANT
                                                              : Status::DROPPED_PARTICIPANT,
                                    data, ignored);
  EXPECT_FALSE(ignored) << "the middleware connects the peer";
}
constexpr const char* kSubject = "";

#endif

TEST(PeerListener, ReportsWhoComesAndGoes) {
  Listener listener;
  for (const Change change : {Change::kFound, Change::kLeft, Change::kLost}) {
    report(listener, change);
    const DiscoveredPeer& peer = listener.peers.back();
    EXPECT_EQ(peer.id.guidPrefix, prefix_of_listened_peer());
    EXPECT_EQ(peer.name, "robot/ga_worker");
    EXPECT_EQ(peer.subject, kSubject);
    EXPECT_EQ(peer.gone, change != Change::kFound);
  }
}

TEST(PeerListener, ReportsWhetherAPeerHasProvenItsIdentity) {
  using Info = rtps::ParticipantAuthenticationInfo;
  Listener listener;
  for (const bool authorized : {true, false}) {
    Info info;
    info.status = authorized ? Info::AUTHORIZED_PARTICIPANT : Info::UNAUTHORIZED_PARTICIPANT;
    info.guid.guidPrefix = prefix_of_listened_peer();
    listener.onParticipantAuthentication(nullptr, std::move(info));
    EXPECT_EQ(listener.authenticated.back(), std::pair(prefix_of_listened_peer(), authorized));
  }
}

}  // namespace
}  // namespace topogeo::messaging
