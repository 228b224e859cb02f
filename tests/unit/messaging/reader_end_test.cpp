// Readers of the middleware that are destroyed while a writer is matched.
#include "fast_dds/reader_end.hpp"

#include <cstdlib>
#include <stdexcept>

#include <fastdds/rtps/RTPSDomain.h>
#include <fastdds/rtps/attributes/HistoryAttributes.h>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/participant/RTPSParticipant.h>
#include <fastdds/rtps/reader/RTPSReader.h>
#include <fastdds/rtps/reader/ReaderListener.h>
#include <fastdds/rtps/writer/RTPSWriter.h>
#include <fastrtps/attributes/TopicAttributes.h>
#include <fastrtps/qos/ReaderQos.h>
#include <fastrtps/qos/WriterQos.h>
#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

namespace fastrtps = eprosima::fastrtps;
namespace rtps = eprosima::fastrtps::rtps;

/// Makes a reader and a writer of one participant. They are never removed: the test process exits.
void make_endpoints(rtps::ReaderListener& listener) {
  rtps::RTPSParticipantAttributes attributes;
  attributes.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SIMPLE;
  rtps::RTPSParticipant* const participant = rtps::RTPSDomain::createParticipant(0, attributes);
  if (participant == nullptr) throw std::runtime_error("no participant");
  rtps::ReaderAttributes reader_attributes;
  rtps::WriterAttributes writer_attributes;
  fastrtps::WriterQos writer_qos;
  writer_qos.m_reliability.kind = eprosima::fastdds::dds::BEST_EFFORT_RELIABILITY_QOS;
  auto* const received = new rtps::ReaderHistory{rtps::HistoryAttributes()};
  auto* const sent = new rtps::WriterHistory{rtps::HistoryAttributes()};
  rtps::RTPSReader* const reader =
      rtps::RTPSDomain::createRTPSReader(participant, reader_attributes, received, &listener);
  rtps::RTPSWriter* const writer =
      rtps::RTPSDomain::createRTPSWriter(participant, writer_attributes, sent);
  fastrtps::TopicAttributes topic;
  topic.topicKind = rtps::NO_KEY;
  topic.topicName = "topic";
  topic.topicDataType = "type";
  if (reader == nullptr || writer == nullptr ||
      !participant->registerReader(reader, topic, fastrtps::ReaderQos()) ||
      !participant->registerWriter(writer, topic, writer_qos)) {
    throw std::runtime_error("no reader or writer");
  }
}

/// Removes itself at the first match, like the listener of a reader that another thread destroys.
class GoingListener : public rtps::ReaderListener {
 public:
  using ReaderListener::onReaderMatched;
  void onReaderMatched(rtps::RTPSReader* reader, rtps::MatchingInfo& /*info*/) override {
    ++calls;
    reader->setListener(nullptr);
  }
  int calls = 0;
};

[[noreturn]] void match_a_reader_that_ends() {
  let_readers_end_beside_peers();
  GoingListener listener;
  make_endpoints(listener);
  std::_Exit(listener.calls == 1 ? 0 : 2);
}

TEST(ReaderEndDeathTest, AReaderWithoutListenerIsMatched) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(match_a_reader_that_ends(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace topogeo::messaging
