// Writers of the middleware that are destroyed with messages that their readers have not confirmed.
#include "fast_dds/writer_end.hpp"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>

#include <fastdds/rtps/RTPSDomain.h>
#include <fastdds/rtps/attributes/HistoryAttributes.h>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/builtin/data/ReaderProxyData.h>
#include <fastdds/rtps/history/IPayloadPool.h>
#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/participant/RTPSParticipant.h>
#include <fastdds/rtps/writer/RTPSWriter.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr int kMessages = 1'000;
constexpr std::uint32_t kSize_bytes = 64;
constexpr std::chrono::microseconds kGivingBack{100};
/// Many heartbeats happen while one lock is released and taken again some thousand times.
constexpr std::uint32_t kHeartbeatPeriod_ns = 100'000;

/// Releases payloads slowly.
class SlowPool : public rtps::IPayloadPool {
 public:
  bool get_payload(std::uint32_t size, rtps::CacheChange_t& change) override {
    change.serializedPayload.reserve(size);
    change.payload_owner(this);
    return true;
  }
  bool get_payload(rtps::SerializedPayload_t& data, rtps::IPayloadPool*& /*owner*/,
                   rtps::CacheChange_t& change) override {
    return get_payload(data.length, change);
  }
  bool release_payload(rtps::CacheChange_t& change) override {
    std::this_thread::sleep_for(kGivingBack);  // heartbeats come while the writer ends
    change.serializedPayload.empty();
    change.payload_owner(nullptr);
    return true;
  }
};

/// A reader that does not exist: its address accepts no packets, so it confirms nothing.
rtps::ReaderProxyData silent_reader() {
  rtps::ReaderProxyData reader(1, 0);
  rtps::GUID_t guid;
  guid.guidPrefix.value[0] = 1;
  guid.entityId = rtps::EntityId_t(0x00000107);
  reader.guid(guid);
  reader.m_qos.m_reliability.kind = eprosima::fastdds::dds::RELIABLE_RELIABILITY_QOS;
  rtps::Locator_t nowhere(LOCATOR_KIND_UDPv4, 9);
  rtps::IPLocator::setIPv4(nowhere, 127, 0, 0, 1);
  reader.add_unicast_locator(nowhere);
  return reader;
}

[[noreturn]] void end_a_writer_with_messages_under_way() {
  ::alarm(static_cast<unsigned>(test::hang_limit().count()));
  let_writers_end_undisturbed();
  rtps::RTPSParticipantAttributes attributes;
  attributes.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::NONE;
  attributes.builtin.use_WriterLivelinessProtocol = false;
  rtps::RTPSParticipant* const participant = rtps::RTPSDomain::createParticipant(0, attributes);
  if (participant == nullptr) throw std::runtime_error("no participant");
  rtps::HistoryAttributes history_attributes;
  history_attributes.payloadMaxSize = kSize_bytes;
  rtps::WriterHistory history(history_attributes);
  rtps::WriterAttributes writer_attributes;
  writer_attributes.endpoint.reliabilityKind = rtps::RELIABLE;
  writer_attributes.times.heartbeatPeriod = {0, kHeartbeatPeriod_ns};
  rtps::RTPSWriter* const writer = rtps::RTPSDomain::createRTPSWriter(
      participant, writer_attributes, std::make_shared<SlowPool>(), &history);
  if (writer == nullptr || !writer->matched_reader_add(silent_reader())) {
    throw std::runtime_error("no writer");
  }
  for (int i = 0; i < kMessages; ++i) {
    rtps::CacheChange_t* const change = writer->new_change([] { return kSize_bytes; }, rtps::ALIVE);
    change->serializedPayload.length = kSize_bytes;
    if (!history.add_change(change)) throw std::runtime_error("no room for a message");
  }
  const bool removed = rtps::RTPSDomain::removeRTPSWriter(writer);
  std::_Exit(removed ? 0 : 2);
}

/// Runs in a process of its own, whose alarm ends a deadlock.
TEST(WriterEndDeathTest, HeartbeatsLeaveMessagesAloneThatAreGivenBack) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(end_a_writer_with_messages_under_way(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace topogeo::messaging
