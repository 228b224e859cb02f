// Incompatible readers and writers of a domain, and how they are found.
#include "topogeo/messaging/discovery.hpp"

#include <gmock/gmock.h>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

using testing::IsEmpty;

RemoteEndpoint endpoint(const std::string& participant, bool writer, const OfferedQos& qos,
                        std::vector<std::string> partitions = {"run"}) {
  RemoteEndpoint result;
  result.participant = participant;
  result.topic = "topogeo/v17/scan";
  result.type = "topogeo::msg::Scan";
  result.writer = writer;
  result.partitions = std::move(partitions);
  result.qos = qos;
  return result;
}

/// QoS differences between a writer and a reader.
std::vector<std::string> between(const OfferedQos& offered, const OfferedQos& requested) {
  const std::vector<RemoteEndpoint> both = {endpoint("w", true, offered),
                                            endpoint("r", false, requested)};
  std::vector<std::string> what;
  for (const Mismatch& mismatch : find_mismatches(both)) what.push_back(mismatch.what);
  return what;
}

TEST(Mismatches, EachPolicyByItsRule) {
  using Policies = std::vector<std::string>;
  EXPECT_THAT(between({}, {}), IsEmpty());
  EXPECT_EQ(between({.reliable = false}, {.reliable = true}), Policies{"reliability"});
  EXPECT_THAT(between({.reliable = true}, {.reliable = false}), IsEmpty());
  EXPECT_EQ(between({.durability = 0}, {.durability = 1}), Policies{"durability"});
  EXPECT_THAT(between({.durability = 1}, {.durability = 0}), IsEmpty());
  EXPECT_EQ(between({.deadline_s = 2.0}, {.deadline_s = 1.0}), Policies{"deadline"});
  EXPECT_EQ(between({}, {.deadline_s = 1.0}), Policies{"deadline"}) << "none is longer than any";
  EXPECT_THAT(between({.deadline_s = 1.0}, {}), IsEmpty());
  EXPECT_EQ(between({.liveliness = 0}, {.liveliness = 2}), Policies{"liveliness"});
  EXPECT_EQ(between({.lease_s = 2.0}, {.lease_s = 1.0}), Policies{"liveliness"});
  EXPECT_EQ(between({.exclusive = true}, {.exclusive = false}), Policies{"ownership"});
}

TEST(Mismatches, OnlyOfThoseThatMeet) {
  const OfferedQos best_effort{};
  const OfferedQos reliable{.reliable = true};
  std::vector<RemoteEndpoint> endpoints = {endpoint("w", true, best_effort, {"run-1"}),
                                           endpoint("r", false, reliable, {"run-2"})};
  EXPECT_THAT(find_mismatches(endpoints), IsEmpty()) << "other partition";
  endpoints[1].partitions = {"run-*"};
  EXPECT_EQ(find_mismatches(endpoints).size(), 1U);
  endpoints[1].topic = "topogeo/v17/sonar";
  EXPECT_THAT(find_mismatches(endpoints), IsEmpty()) << "other topic";
  endpoints[1] = endpoint("r", true, reliable, {"run-1"});
  EXPECT_THAT(find_mismatches(endpoints), IsEmpty()) << "two writers";
  endpoints[1] = endpoint("r", false, best_effort, {"run-1"});
  endpoints[1].type = "Other";
  ASSERT_EQ(find_mismatches(endpoints).size(), 1U);
  EXPECT_EQ(find_mismatches(endpoints)[0].what, "type");
}

TEST(Mismatches, AreNamedOnceForTwoParticipants) {
  const std::vector<RemoteEndpoint> endpoints = {endpoint("w", true, {}), endpoint("w", true, {}),
                                                 endpoint("r", false, {.reliable = true})};
  const std::vector<Mismatch> found = find_mismatches(endpoints);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].writer.participant, "w");
  EXPECT_EQ(found[0].reader.participant, "r");
}

TEST(WireVersion, IsInTheNameOfTheTopic) {
  EXPECT_EQ(wire_version(std::string(kScan)), msg::kSchemaVersion);
  EXPECT_EQ(wire_version("topogeo/v9/scan"), 9U);
  EXPECT_EQ(wire_version("topogeo/v9"), 0U);
  EXPECT_EQ(wire_version("topogeo/vx/scan"), 0U);
  EXPECT_EQ(wire_version("rt/topogeo/v9/scan"), 0U);
}

class Discovery : public testing::Test {
 protected:
  static ParticipantOptions observing(const std::string& partition) {
    ParticipantOptions options = options_in(partition);
    options.observe = true;
    return options;
  }
  /// Endpoints of this test's partition only, because other tests use the domain, too.
  [[nodiscard]] std::vector<RemoteEndpoint> discovered() const {
    std::vector<RemoteEndpoint> own = observer_.discovered();
    std::erase_if(own, [&](const RemoteEndpoint& one) {
      return one.partitions != std::vector<std::string>{partition_};
    });
    return own;
  }

  std::string partition_ = random_partition();
  Participant observer_{observing(partition_)};
};

TEST_F(Discovery, EndpointsComeWithTheirQosAndGo) {
  {
    const Participant other(options_in(partition_));
    const Writer<msg::ServiceStatus> writer(other);
    const Reader<msg::Scan> reader(other);
    ASSERT_TRUE(test::wait_for("a reader and a writer", [&] { return discovered().size() == 2; }));
    const auto all = discovered();
    const auto status = std::ranges::find(all, true, &RemoteEndpoint::writer);
    ASSERT_NE(status, all.end());
    EXPECT_EQ(status->topic, kServiceStatus);
    EXPECT_EQ(status->participant, "test");
    EXPECT_TRUE(status->qos.reliable);
    EXPECT_EQ(status->qos.durability, 1U);
    EXPECT_EQ(status->qos.lease_s, 1.0);
    EXPECT_THAT(find_mismatches(all), IsEmpty());
  }
  EXPECT_TRUE(test::wait_for("both endpoints to go", [&] { return discovered().empty(); }));
}

TEST_F(Discovery, IncompatiblePairIsFound) {
  const Participant one(options_in(partition_));
  const Participant two(options_in(partition_));
  const Writer<msg::Goal> writer(one, "command");  // best effort, a reader of goals is reliable
  const Reader<msg::Goal> reader(two);
  ASSERT_TRUE(test::wait_for("a reader and a writer", [&] { return discovered().size() == 2; }));
  const std::vector<Mismatch> found = find_mismatches(discovered());
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].writer.topic, kGoal);
}

TEST_F(Discovery, OthersDoNotObserve) {
  const Participant other(options_in(partition_));
  const Writer<msg::Goal> writer(other);
  ASSERT_TRUE(test::wait_for("a writer", [&] { return discovered().size() == 1; }));
  EXPECT_THAT(other.discovered(), IsEmpty());
}

}  // namespace
}  // namespace topogeo::messaging
