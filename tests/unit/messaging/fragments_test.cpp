// Gaps in a reader's samples, and the reader's lock.
#include "fast_dds/fragments.hpp"

#include <thread>

#include <fastdds/rtps/RTPSDomain.h>
#include <fastdds/rtps/attributes/HistoryAttributes.h>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/participant/RTPSParticipant.h>
#include <fastdds/rtps/reader/ReaderListener.h>
#include <fastdds/rtps/reader/StatefulReader.h>
#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

/// Releases the reader's lock, like the middleware's discovery listeners, to take their own.
class GivingListener : public rtps::ReaderListener {
 public:
  void onNewCacheChangeAdded(rtps::RTPSReader* reader,
                             const rtps::CacheChange_t* /*change*/) override {
    ++calls;
    reader->getMutex().unlock();
    std::thread([&] {
      given = reader->getMutex().try_lock();
      if (given) reader->getMutex().unlock();
    }).join();
    reader->getMutex().lock();
  }
  int calls = 0;
  bool given = false;
};

// Otherwise a thread that holds discovery's lock and waits for the reader's lock would deadlock.
TEST(Gaps, LeaveTheReadersLockToWhoIsToldOfTheNextMessage) {
  correct_fragments();
  rtps::RTPSParticipantAttributes attributes;
  attributes.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::NONE;
  attributes.builtin.use_WriterLivelinessProtocol = false;
  rtps::RTPSParticipant* const participant = rtps::RTPSDomain::createParticipant(0, attributes);
  ASSERT_NE(participant, nullptr);
  rtps::ReaderHistory history{rtps::HistoryAttributes()};
  rtps::ReaderAttributes reader_attributes;
  reader_attributes.endpoint.reliabilityKind = rtps::RELIABLE;
  GivingListener listener;
  auto* const reader = dynamic_cast<rtps::StatefulReader*>(
      rtps::RTPSDomain::createRTPSReader(participant, reader_attributes, &history, &listener));
  ASSERT_NE(reader, nullptr);
  rtps::GUID_t guid;
  guid.guidPrefix.value[0] = 1;
  guid.entityId = rtps::EntityId_t(0x00000103);
  rtps::WriterProxyData writer(1, 0);
  writer.guid(guid);
  writer.persistence_guid(guid);
  writer.m_qos.m_reliability.kind = eprosima::fastdds::dds::RELIABLE_RELIABILITY_QOS;
  ASSERT_TRUE(reader->matched_writer_add(writer));
  rtps::CacheChange_t second(4);
  second.kind = rtps::ALIVE;
  second.writerGUID = guid;
  second.sequenceNumber = rtps::SequenceNumber_t(0, 2);
  second.serializedPayload.length = 4;
  ASSERT_TRUE(reader->processDataMsg(&second));
  ASSERT_EQ(listener.calls, 0) << "the first one is missing";
  const rtps::SequenceNumber_t first(0, 1);
  reader->processGapMsg(guid, first, rtps::SequenceNumberSet_t(second.sequenceNumber));
  EXPECT_EQ(listener.calls, 1);
  EXPECT_TRUE(listener.given);
  rtps::RTPSDomain::removeRTPSParticipant(participant);
}

}  // namespace
}  // namespace topogeo::messaging
