// Programs that read several topics of one writer, with readers that connect one after the other.
#include "topogeo/messaging/connected_programs.hpp"

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fixture.hpp"
#include "read_with.hpp"
#include "waiting.hpp"

namespace topogeo::messaging {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> parsed(const std::string& text) {
  return parse_read_with(std::vector<std::uint8_t>(text.begin(), text.end()));
}

TEST(ReadWith, IsFoundInTheUserDataOfAReader) {
  EXPECT_THAT(parse_read_with(announce_read_with(std::vector{kOdometry, kSonar})),
              ElementsAre(kOdometry, kSonar));
  EXPECT_THAT(parsed("enclave=/;read_with=a,b"), ElementsAre("a", "b")) << "beside other keys";
}

TEST(ReadWith, IsNotInUserDataOfOthers) {
  EXPECT_TRUE(announce_read_with({}).empty());
  for (const char* text : {"", ";", "enclave=/;", "read_with", "read_with=", "read_with=,,;",
                           "xread_with=a", "a;b,c"}) {
    EXPECT_THAT(parsed(text), IsEmpty()) << text;
  }
  EXPECT_THAT(parsed("read_with=" + std::string(2000, 'a')), IsEmpty()) << "a stranger's";
}

class ConnectedProgramsTest : public TwoParticipants {
 protected:
  [[nodiscard]] bool connected(int readers) const {
    return test::wait_for("readers of scans", [&] { return scans_.matched() == readers; });
  }
  [[nodiscard]] bool whole(int programs) const {
    return test::wait_for("connected programs", [&] { return programs_.count() == programs; });
  }

  Writer<msg::Scan> scans_{sender_};
  Writer<msg::Odometry> odometry_{sender_};
  ConnectedPrograms programs_{scans_, odometry_};
};

// The second reader is created when the first is connected: the test controls the delay between two
// announcements of discovery.
TEST_F(ConnectedProgramsTest, AReaderIsNoneBeforeTheOtherOneIsConnected) {
  const Reader<msg::Scan> scans(receiver_, {.read_with = {kOdometry}});
  ASSERT_TRUE(connected(1));
  EXPECT_EQ(programs_.count(), 0);
  EXPECT_EQ(programs_.missing(), "odometry");
  std::optional<Reader<msg::Odometry>> odometry(receiver_);
  ASSERT_TRUE(whole(1));
  EXPECT_EQ(programs_.missing(), "");
  odometry.reset();
  EXPECT_TRUE(whole(0)) << "it has left";
}

TEST_F(ConnectedProgramsTest, WhatIsSentThenReachesBoth) {
  Reader<msg::Scan> scans(receiver_, {std::string(kReplayRole), {}, {kOdometry}});
  Writer<msg::Scan> scans_out(sender_, kReplayRole);
  Writer<msg::Odometry> odometry_out(sender_, kReplayRole);
  const ConnectedPrograms programs(scans_out, odometry_out);
  ASSERT_TRUE(test::wait_for("a reader of scans", [&] { return scans_out.matched() == 1; }));
  Reader<msg::Odometry> odometry(receiver_, {std::string(kReplayRole), {}});
  ASSERT_TRUE(test::wait_for("a connected program", [&] { return programs.count() == 1; }));
  constexpr std::uint64_t kSent = 50;
  for (std::uint64_t i = 0; i < kSent; ++i) {
    ASSERT_TRUE(scans_out.write(message<msg::Scan>(i)));
    ASSERT_TRUE(odometry_out.write(message<msg::Odometry>(i)));
  }
  std::vector<std::uint64_t> scans_in;
  std::vector<std::uint64_t> odometry_in;
  const auto take = [&] {
    scans.take([&](const msg::Scan& m, const SampleInfo& info) {
      if (info.valid) scans_in.push_back(m.sequence_number());
    });
    odometry.take([&](const msg::Odometry& m, const SampleInfo& info) {
      if (info.valid) odometry_in.push_back(m.sequence_number());
    });
    return scans_in.size() == kSent && odometry_in.size() == kSent;
  };
  EXPECT_TRUE(test::wait_for("all that was sent", take));
  EXPECT_EQ(odometry_in, scans_in);
}

TEST_F(ConnectedProgramsTest, EachProgramHasItsOwn) {
  const Participant other(options_in(partition_));
  const Reader<msg::Odometry> elsewhere(other);
  const Reader<msg::Scan> scans(receiver_, {.read_with = {kOdometry}});
  ASSERT_TRUE(connected(1));
  ASSERT_TRUE(test::wait_for("a reader of odometry", [&] { return odometry_.matched() == 1; }));
  EXPECT_EQ(programs_.count(), 0) << "the odometry of another program";
}

TEST_F(ConnectedProgramsTest, WhatAnotherProgramWritesIsNotWaitedFor) {
  const Reader<msg::Scan> scans(receiver_, {.read_with = {kGroundTruth}});
  EXPECT_TRUE(whole(1));
}

TEST_F(ConnectedProgramsTest, AReaderThatAnnouncesNothingCounts) {
  const Reader<msg::Scan> scans(receiver_);
  EXPECT_TRUE(whole(1));
  EXPECT_EQ(programs_.missing(), "");
}

TEST_F(ConnectedProgramsTest, AProgramWithTwoReadersIsOne) {
  const Reader<msg::Scan> one(receiver_);
  ASSERT_TRUE(whole(1));
  const Reader<msg::Scan> two(receiver_, {.read_with = {kOdometry}});
  ASSERT_TRUE(connected(2));
  EXPECT_EQ(programs_.count(), 0) << "one of them lacks something";
  const Reader<msg::Odometry> odometry(receiver_);
  EXPECT_TRUE(whole(1));
}

TEST_F(ConnectedProgramsTest, OneThatObservesHearsOfThemToo) {
  ParticipantOptions options = options_in(partition_);
  options.observe = true;
  const Participant observer(options);
  const Writer<msg::Scan> scans_out(observer);
  const Writer<msg::Odometry> odometry_out(observer);
  const ConnectedPrograms programs(scans_out, odometry_out);
  const Reader<msg::Scan> scans(receiver_, {.read_with = {kOdometry}});
  ASSERT_TRUE(test::wait_for("a reader of scans", [&] { return scans_out.matched() == 1; }));
  EXPECT_EQ(programs.missing(), "odometry");
}

}  // namespace
}  // namespace topogeo::messaging
