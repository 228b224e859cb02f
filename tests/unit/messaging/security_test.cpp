// Names of peers that security refuses.
#include "security.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::messaging {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kGuid = "01.00.00.00.00.00.00.00.00.00.00.07";

rtps::GuidPrefix_t prefix_of_peer() {
  rtps::GuidPrefix_t prefix;
  prefix.value[0] = 1;
  prefix.value[11] = 7;
  return prefix;
}

class Refusals : public testing::Test {
 protected:
  Refusals() { listener_.take(); }  // entries of other tests in this process

  /// The peer is discovered, or leaves.
  void peer(const std::string& name, const std::string& subject, bool gone = false) {
    DiscoveredPeer peer;
    peer.id.guidPrefix = prefix_of_peer();
    peer.name = name;
    peer.subject = subject;
    peer.gone = gone;
    listener_.on_peer(peer);
  }

  void authenticate(bool authorized) { listener_.on_authentication(prefix_of_peer(), authorized); }

  RefusalListener listener_;
};

TEST_F(Refusals, NameTheParticipantAndItsCertificate) {
  peer("robot/ga_worker", "CN=ga_worker.pc1,O=topogeo");
  authenticate(false);
  EXPECT_THAT(listener_.take(), ElementsAre("'robot/ga_worker' (CN=ga_worker.pc1,O=topogeo; " +
                                            std::string(kGuid) + ") fails authentication"));
  EXPECT_THAT(listener_.take(), IsEmpty()) << "each once";
}

TEST_F(Refusals, NameThePeerThatIsDeniedATopic) {
  // A worker under the name of the map store, with its own certificate.
  peer("robot/map_store", "CN=ga_worker.pc1,O=topogeo");
  authenticate(true);
  note_denial({prefix_of_peer(), "topogeo/v17/map", true, false});
  note_denial({prefix_of_peer(), "topogeo/v17/scan", false, true});
  const std::string who =
      "'robot/map_store' (CN=ga_worker.pc1,O=topogeo; " + std::string(kGuid) + ") ";
  EXPECT_THAT(listener_.take(),
              ElementsAre(who + "may not write topogeo/v17/map",
                          who + "may not read topogeo/v17/scan: its governance differs"));
  EXPECT_THAT(listener_.take(), IsEmpty()) << "each once";
}

// A peer may announce any subject.
TEST_F(Refusals, NameTheCertificateThatThePeerHasShown) {
  peer("robot/map_store", "/O=topogeo/CN=map_store.robot");
  note_subject(prefix_of_peer(), "/O=topogeo/CN=ga_worker.pc1");
  authenticate(true);
  note_denial({prefix_of_peer(), "topogeo/v17/map", true, false});
  EXPECT_THAT(listener_.take(),
              ElementsAre("'robot/map_store' (/O=topogeo/CN=ga_worker.pc1; " + std::string(kGuid) +
                          ") may not write topogeo/v17/map"));
  peer("", "", true);
  peer("robot/map_store", "/O=topogeo/CN=map_store.robot");
  authenticate(false);
  EXPECT_THAT(listener_.take(), ElementsAre(testing::HasSubstr("CN=map_store.robot")))
      << "who comes with the same id has to show it again";
}

TEST_F(Refusals, NameTheRobotOfASampleThatIsDenied) {
  peer("anna/sensor_gateway", "/O=topogeo/OU=anna/CN=sensor_gateway.anna");
  authenticate(true);
  note_denial({prefix_of_peer(), "topogeo/v17/scan", true, false, "bert\n"});
  EXPECT_THAT(
      listener_.take(),
      ElementsAre("'anna/sensor_gateway' (/O=topogeo/OU=anna/CN=sensor_gateway.anna; " +
                  std::string(kGuid) + ") may not write topogeo/v17/scan for robot 'bert?'"));
}

TEST_F(Refusals, NameAPeerThatHasLeft) {
  peer("robot/map_store", "CN=ga_worker.pc1,O=topogeo");
  authenticate(true);
  note_denial({prefix_of_peer(), "topogeo/v17/map", true, false});
  peer("", "", true);
  EXPECT_THAT(listener_.take(),
              ElementsAre("'robot/map_store' (CN=ga_worker.pc1,O=topogeo; " + std::string(kGuid) +
                          ") may not write topogeo/v17/map"));
}

TEST_F(Refusals, AreOneShortLineEach) {
  peer("line\nof a log\x1b[2J", std::string(10'000, 'x'));
  authenticate(false);
  EXPECT_THAT(listener_.take(), ElementsAre("'line?of a log?[2J' (" + std::string(128, 'x') + "; " +
                                            kGuid + ") fails authentication"));
}

TEST_F(Refusals, AreBounded) {
  for (int i = 0; i < 1'000; ++i) {
    note_denial({prefix_of_peer(), "topogeo/v17/topic" + std::to_string(i), true, false});
  }
  const std::vector<std::string> lines = listener_.take();
  ASSERT_EQ(lines.size(), 256U);
  EXPECT_EQ(lines.back(),
            "'unnamed' (" + std::string(kGuid) + ") may not write topogeo/v17/topic999");
}

}  // namespace
}  // namespace topogeo::messaging
