// Readers of the middleware that are destroyed while a writer is matched or lost.
#include "fast_dds/reader_end.hpp"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <stdexcept>
#include <thread>

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

#include "waiting.hpp"

namespace topogeo::messaging {
namespace {

namespace fastdds = eprosima::fastdds::dds;
namespace fastrtps = eprosima::fastrtps;
namespace rtps = eprosima::fastrtps::rtps;

/// A reader and a writer of one participant. They are never removed: the test processes just exit.
struct Endpoints {
  rtps::RTPSReader* reader;
  rtps::RTPSWriter* writer;
  rtps::WriterHistory* sent;
};

// Both have a lease that the writer must renew by writing; 0: none.
Endpoints make_endpoints(rtps::ReaderListener& listener, double lease_s) {
  rtps::RTPSParticipantAttributes attributes;
  attributes.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SIMPLE;
  rtps::RTPSParticipant* const participant = rtps::RTPSDomain::createParticipant(0, attributes);
  if (participant == nullptr) throw std::runtime_error("no participant");
  rtps::ReaderAttributes reader_attributes;
  rtps::WriterAttributes writer_attributes;
  fastrtps::ReaderQos reader_qos;
  fastrtps::WriterQos writer_qos;
  writer_qos.m_reliability.kind = fastdds::BEST_EFFORT_RELIABILITY_QOS;
  if (lease_s > 0.0) {
    const fastrtps::Duration_t lease(static_cast<long double>(lease_s));
    const auto kind = fastdds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    reader_attributes.liveliness_kind_ = writer_attributes.liveliness_kind = kind;
    reader_attributes.liveliness_lease_duration = writer_attributes.liveliness_lease_duration =
        lease;
    reader_qos.m_liveliness.kind = writer_qos.m_liveliness.kind = kind;
    reader_qos.m_liveliness.lease_duration = writer_qos.m_liveliness.lease_duration = lease;
  }
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
      !participant->registerReader(reader, topic, reader_qos) ||
      !participant->registerWriter(writer, topic, writer_qos)) {
    throw std::runtime_error("no reader or writer");
  }
  return {reader, writer, sent};
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
  make_endpoints(listener, 0.0);
  std::_Exit(listener.calls == 1 ? 0 : 2);
}

TEST(ReaderEndDeathTest, AReaderWithoutListenerIsMatched) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(match_a_reader_that_ends(), ::testing::ExitedWithCode(0), "");
}

/// Is slow when a writer is no longer alive.
class SlowListener : public rtps::ReaderListener {
 public:
  void on_liveliness_changed(rtps::RTPSReader* /*reader*/,
                             const fastdds::LivelinessChangedStatus& status) override {
    if (status.not_alive_count == 0) return;
    begun.set_value();
    // Longer than a removal that does not wait; a slow machine can only hide the error.
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    done = true;
  }
  std::promise<void> begun;
  std::atomic<bool> done = false;
};

[[noreturn]] void remove_a_reader_that_is_told_of_a_loss() {
  let_readers_end_beside_peers();
  SlowListener listener;
  const Endpoints endpoints = make_endpoints(listener, 0.05);
  rtps::CacheChange_t* const change = endpoints.writer->new_change([] { return 8U; }, rtps::ALIVE);
  if (change == nullptr || !endpoints.sent->add_change(change)) std::_Exit(3);
  std::future<void> begun = listener.begun.get_future();
  if (begun.wait_for(test::hang_limit()) != std::future_status::ready) std::_Exit(4);
  rtps::RTPSDomain::removeRTPSReader(endpoints.reader);
  std::_Exit(listener.done ? 0 : 2);
}

TEST(ReaderEndDeathTest, AReaderStaysUntilItIsToldOfALoss) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(remove_a_reader_that_is_told_of_a_loss(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace topogeo::messaging
