// The map over DDS, read by a program outside the project.
#include "topogeo/map_client/map_reader.hpp"

#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"

#include "messaging/fixture.hpp"
#include "simulated_store.hpp"
#include "waiting.hpp"

namespace topogeo::map_client {
namespace {

using std::chrono::milliseconds;

class Reading : public testing::Test {
 protected:
  void send(msg::MapElement element) {
    messaging::set_robot_id(element, "robot");
    ASSERT_TRUE(writer_->write(element));
  }
  void dispose(msg::MapElement element) {
    messaging::set_robot_id(element, "robot");
    writer_->dispose(element);
  }
  /// Two nodes and a branch.
  void send_first_map() {
    send(store_.node(1, 0.0));
    send(store_.node(2, 5.0));
    send(store_.branch(1, 1, 2));
    send(store_.summary(10));
  }
  /// Waits until the reader has a version.
  static bool wait_for(MapReader& reader, std::uint64_t version) {
    return test::wait_for("version " + std::to_string(version) + " of the map", [&] {
      static_cast<void>(reader.wait(milliseconds(20)));
      return reader.is_current() && reader.map()->version == version;
    });
  }

  std::string partition_ = messaging::random_partition();
  messaging::Participant participant_{messaging::options_in(partition_)};
  std::optional<messaging::Writer<msg::MapElement>> writer_{participant_};
  SimulatedStore store_{77};
  MapReaderOptions options_{.partition = partition_};
};

TEST_F(Reading, FollowsFromTheBeginningOrLateAndHearsOfRemovals) {
  MapReader early(options_);
  EXPECT_FALSE(early.wait(milliseconds(1)));
  EXPECT_EQ(early.map(), nullptr);
  send_first_map();
  ASSERT_TRUE(wait_for(early, 10));
  EXPECT_EQ(early.stores(), 1);
  MapReader late(options_);
  ASSERT_TRUE(wait_for(late, 10));
  dispose(store_.dispose(msg::kElementBranch, 1));
  send(store_.node(2, 6.0));
  send(store_.summary(11));
  MapReader later(options_);
  for (MapReader* reader : {&early, &late, &later}) {
    ASSERT_TRUE(wait_for(*reader, 11));
    EXPECT_EQ(reader->map()->map_id, 77U);
    EXPECT_EQ(reader->map()->nodes.size(), 2U);
    EXPECT_EQ(reader->map()->nodes.at(2)->node_position().x_m(), 6.0);
    EXPECT_TRUE(reader->map()->branches.empty());
    EXPECT_EQ(reader->restarts(), 0);
  }
}

TEST_F(Reading, TheMapStandsUntilAnotherStoreHasSentItsOwn) {
  MapReader reader(options_);
  send_first_map();
  ASSERT_TRUE(wait_for(reader, 10));
  writer_.reset();
  ASSERT_TRUE(test::wait_for("the store to go", [&] {
    EXPECT_FALSE(reader.take());
    return reader.stores() == 0;
  }));
  ASSERT_NE(reader.map(), nullptr);
  EXPECT_EQ(reader.map()->nodes.size(), 2U);
  writer_.emplace(participant_);
  store_ = SimulatedStore(78);
  send(store_.node(2, 7.0));
  send(store_.summary(3));
  ASSERT_TRUE(wait_for(reader, 3));
  EXPECT_EQ(reader.map()->map_id, 78U);
  EXPECT_EQ(reader.map()->nodes.size(), 1U);
}

TEST_F(Reading, WhatStaysIncompleteIsReadAnew) {
  options_.patience = milliseconds(300);  // longer than a map takes to arrive on a slow machine
  MapReader reader(options_);
  const msg::MapElement kept_back = store_.node(1, 0.0);
  send(store_.summary(10));
  ASSERT_TRUE(test::wait_for("the map to be read anew", [&] {
    EXPECT_FALSE(reader.wait(milliseconds(20)));
    return reader.restarts() > 1;
  }));
  EXPECT_EQ(reader.map(), nullptr);
  send(kept_back);
  EXPECT_TRUE(wait_for(reader, 10));
}

// The program reads nothing until the other writer has written.
TEST_F(Reading, AnotherWriterOfAnElementTakesNothingFromTheStores) {
  MapReader reader(options_);
  messaging::Writer<msg::MapElement> stranger(participant_);
  ASSERT_TRUE(writer_->wait_for_matched(1, test::hang_limit()));
  ASSERT_TRUE(stranger.wait_for_matched(1, test::hang_limit()));
  send_first_map();
  ASSERT_TRUE(writer_->wait_for_acknowledgments(test::hang_limit()));
  msg::MapElement element = SimulatedStore().node(1, 100.0);
  messaging::set_robot_id(element, "robot");
  ASSERT_TRUE(stranger.write(element));
  ASSERT_TRUE(stranger.wait_for_acknowledgments(test::hang_limit()));
  EXPECT_TRUE(reader.take());
  ASSERT_NE(reader.map(), nullptr);
  EXPECT_EQ(reader.map()->version, 10U);
  EXPECT_EQ(reader.restarts(), 0);
}

TEST_F(Reading, WhatStaysIncompleteIsReadAnewThoughSamplesGoOnComing) {
  options_.patience = milliseconds(100);
  MapReader reader(options_);
  ASSERT_TRUE(writer_->wait_for_matched(1, test::hang_limit()));
  static_cast<void>(store_.node(1, 0.0));  // never sent
  EXPECT_TRUE(test::wait_for(
      "the map to be read anew", [&] { return reader.restarts() > 0; },
      [&] {
        send(store_.summary(10));
        EXPECT_FALSE(reader.wait(milliseconds(1)));
      }));
}

TEST_F(Reading, InAParticipantOfTheProgramSeveralReadersGetOn) {
  namespace dds = eprosima::fastdds::dds;
  auto* const factory = dds::DomainParticipantFactory::get_instance();
  auto* const own = factory->create_participant(0, dds::PARTICIPANT_QOS_DEFAULT);
  ASSERT_NE(own, nullptr);
  options_.participant = own;
  {
    MapReader one(options_);
    MapReader two(options_);
    send_first_map();
    EXPECT_TRUE(wait_for(one, 10));
    EXPECT_TRUE(wait_for(two, 10));
  }
  using ReturnCode = decltype(factory->delete_participant(own));
  EXPECT_EQ(factory->delete_participant(own), ReturnCode()) << "nothing is left in it";
}

TEST_F(Reading, TheTopicIsThatOfTheMapStore) {
  EXPECT_EQ(messaging::kMapElement, "topogeo/v" + std::to_string(msg::kSchemaVersion) + "/map");
}

}  // namespace
}  // namespace topogeo::map_client
