// A navigator and the localizer whose poses it must receive.
#include "topogeo/messaging/deafness.hpp"

#include <array>
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"

namespace topogeo::messaging {
namespace {

msg::ServiceStatus service(const std::string& name, const std::string& topic, bool sent,
                           double rate_per_s) {
  msg::ServiceStatus status;
  set_header(status, "robot", 0, 0);
  set_service(status, name, name + "-1");
  status.state(msg::kServiceRunning);
  status.uptime_s(60.0);
  msg::TopicTraffic traffic;
  set_text(traffic.topic(), topic, "topic");
  traffic.sent(sent);
  traffic.messages(500);
  traffic.rate_per_s(rate_per_s);
  status.traffic().push_back(traffic);
  return status;
}

class Deafness : public testing::Test {
 protected:
  Deafness() {
    set_text(navigator_.input(), "pose", "input");
    navigator_.inputs(500);
    navigator_.input_age_s(5.7);
  }

  [[nodiscard]] std::string found() const {
    const std::array<HeardStatus, 3> all = {
        {{&navigator_, 0.0}, {&localizer_, sender_age_s_}, {&planner_, 0.0}}};
    return deafness(all[0], all);
  }

  msg::ServiceStatus localizer_ = service("localizer", "pose", true, 10.0);
  msg::ServiceStatus navigator_ = service("navigator", "pose", false, 0.0);
  double sender_age_s_ = 0.0;
  msg::ServiceStatus planner_ = service("planner", "pose", false, 10.0);
};

TEST_F(Deafness, IsSilenceWhileTheSenderSends) {
  EXPECT_EQ(found(), "deaf: none of the 10.0 pose/s of localizer arrives");
  navigator_.state(msg::kServiceWaiting);
  EXPECT_FALSE(found().empty()) << "it may wait for what does not arrive";
}

TEST_F(Deafness, IsNoSilenceOfTheSender) {
  localizer_.traffic()[0].rate_per_s(0.0);  // the robot stands, or the sender is frozen
  EXPECT_EQ(found(), "");
  localizer_.traffic()[0].rate_per_s(0.4);  // one may be in transit
  EXPECT_EQ(found(), "");
}

TEST_F(Deafness, IsNoShortSilence) {
  navigator_.input_age_s(4.9);
  EXPECT_EQ(found(), "");
  navigator_.input_age_s(5.7);
  navigator_.traffic()[0].rate_per_s(0.2);
  EXPECT_EQ(found(), "") << "something arrives";
  navigator_.traffic()[0].rate_per_s(0.0);
  navigator_.traffic()[0].waiting(3);
  EXPECT_EQ(found(), "") << "it is busy with what has arrived";
}

TEST_F(Deafness, IsNotOfOneThatHasJustBegun) {
  navigator_.uptime_s(3.0);
  EXPECT_EQ(found(), "");
  navigator_.uptime_s(60.0);
  localizer_.uptime_s(3.0);
  EXPECT_EQ(found(), "");
  localizer_.uptime_s(60.0);
  localizer_.state(msg::kServiceFinished);
  EXPECT_EQ(found(), "");
}

TEST_F(Deafness, IsNotDecidedWhereTheSenderIsNotKnown) {
  set_robot_id(localizer_, "another");
  EXPECT_EQ(found(), "");
  set_robot_id(localizer_, "robot");
  planner_ = service("localizer", "pose", true, 10.0);
  EXPECT_EQ(found(), "") << "two localizers, perhaps of two partitions";
  planner_ = service("navigator", "pose", false, 10.0);
  EXPECT_EQ(found(), "") << "two navigators";
}

TEST_F(Deafness, IsNotOfATopicWhoseMessagesAreForOthers) {
  localizer_ = service("localizer", "match_tasks", true, 10.0);
  navigator_ = service("ga_worker", "match_tasks", false, 0.0);
  set_text(navigator_.input(), "match_tasks", "input");
  navigator_.input_age_s(60.0);
  EXPECT_EQ(found(), "");
}

TEST_F(Deafness, IsNotOfOneThatReadsWhatItSends) {
  set_robot_id(localizer_, "another");
  navigator_.traffic().push_back(localizer_.traffic()[0]);
  EXPECT_EQ(found(), "");
}

// The rate of a sender that has just stopped is still that of the seconds before.
TEST_F(Deafness, IsNoSilenceThatHasBegunWithinTheWindowOfTheRate) {
  navigator_.input_age_s(5.4);
  EXPECT_EQ(found(), "");
  navigator_.input_age_s(6.4);
  sender_age_s_ = 1.0;
  EXPECT_EQ(found(), "") << "its rate is older than its status";
  navigator_.input_age_s(6.6);
  EXPECT_NE(found(), "");
}

TEST_F(Deafness, IsThatOfOneThatHasNeverHeardAnything) {
  navigator_.inputs(0);
  navigator_.input_age_s(0.0);
  EXPECT_NE(found(), "");
  navigator_.traffic()[0].rate_per_s(2.0);
  EXPECT_EQ(found(), "") << "it gets what is for another robot";
}

TEST_F(Deafness, IsWhatTheServiceReports) {
  localizer_.traffic()[0].rate_per_s(0.2);
  msg::Counter counter;
  set_text(counter.name(), kDeafCounter, "counter");
  navigator_.counters().push_back(counter);
  EXPECT_EQ(found(), "");
  navigator_.counters()[0].value(1.0);
  EXPECT_EQ(found(), "deaf: its own status reports that no pose arrives");
}

/// The navigator's own verdict: both clocks advance by half a second, then it checks.
class DeafnessProof : public Deafness {
 protected:
  DeafnessProof() { localizer_.traffic()[0].messages(1000); }

  /// The localizer sends so many poses in half a second.
  std::string half_a_second(std::uint64_t poses) {
    now_ += std::chrono::milliseconds(500);
    navigator_.uptime_s(navigator_.uptime_s() + 0.5);
    navigator_.input_age_s(navigator_.input_age_s() + 0.5);
    if (localizer_runs_) {
      localizer_.uptime_s(localizer_.uptime_s() + 0.5);
      auto& traffic = localizer_.traffic()[0];
      traffic.messages(traffic.messages() + poses);
      watch_.hear(localizer_, now_);
    }
    watch_.hear(navigator_, now_);
    return watch_.check(navigator_, now_);
  }
  /// The verdict after so many half seconds.
  std::string after(int turns, std::uint64_t poses) {
    std::string why;
    for (int i = 0; i < turns; ++i) why = half_a_second(poses);
    return why;
  }

  DeafnessWatch::Time now_{};
  bool localizer_runs_ = true;
  DeafnessWatch watch_;
};

TEST_F(DeafnessProof, IsWhatWasSentWithinTheSilence) {
  EXPECT_EQ(after(11, 5), "") << "5 s are not over";
  EXPECT_EQ(half_a_second(5), "none of the 50 pose that localizer has sent in 5.0 s has arrived");
}

TEST_F(DeafnessProof, IsThatOfAnInputThatComesSeldom) {
  after(1, 0);
  EXPECT_EQ(after(12, 0), "") << "the sender is silent, too";
  half_a_second(1);
  half_a_second(1);
  EXPECT_EQ(after(3, 0), "") << "one may be on its way";
  half_a_second(1);
  EXPECT_NE(half_a_second(0), "");
}

TEST_F(DeafnessProof, IsNoneOnceSomethingHasArrived) {
  after(11, 5);
  navigator_.traffic()[0].messages(501);
  navigator_.inputs(501);
  EXPECT_EQ(after(11, 5), "") << "it begins anew";
  EXPECT_NE(half_a_second(5), "");
  navigator_.traffic()[0].waiting(1);
  EXPECT_EQ(half_a_second(5), "") << "it is busy";
  navigator_.traffic()[0].waiting(0);
  navigator_.input_age_s(0.1);
  EXPECT_EQ(half_a_second(5), "");
}

TEST_F(DeafnessProof, IsNoneWhileTheSenderIsFrozen) {
  after(4, 5);
  localizer_runs_ = false;
  EXPECT_EQ(after(24, 0), "");
  EXPECT_FALSE(watch_.hears_sender(navigator_, now_));
  localizer_runs_ = true;
  EXPECT_EQ(after(11, 5), "") << "what it sends now may be on its way";
  EXPECT_TRUE(watch_.hears_sender(navigator_, now_));
}

// The sender's statuses arrive all at once when a frozen service continues.
TEST_F(DeafnessProof, IsNoneInTheTimeThatTheServiceItselfStoodStill) {
  half_a_second(5);
  now_ += std::chrono::seconds(12);
  navigator_.input_age_s(17.0);
  localizer_.uptime_s(localizer_.uptime_s() + 12.0);
  localizer_.traffic()[0].messages(1200);
  EXPECT_EQ(watch_.check(navigator_, now_), "") << "the last status is old";
  EXPECT_EQ(half_a_second(5), "");
  EXPECT_EQ(after(10, 5), "");
  EXPECT_NE(half_a_second(5), "") << "it has had 5 s to hear something";
}

// The service's loop has handled a hundred poses in a row without time for its own status, so the
// sender's status is newer.
TEST_F(DeafnessProof, IsNoneWhileItsOwnStatusIsOlderThanWhatItHears) {
  after(2, 0);
  for (int i = 0; i < 12; ++i) {
    now_ += std::chrono::milliseconds(500);
    localizer_.uptime_s(localizer_.uptime_s() + 0.5);
    localizer_.traffic()[0].messages(localizer_.traffic()[0].messages() + 10);
    watch_.hear(localizer_, now_);
    EXPECT_EQ(watch_.check(navigator_, now_), "");
  }
  navigator_.traffic()[0].messages(620);
  navigator_.inputs(620);
  navigator_.input_age_s(0.0);
  EXPECT_EQ(half_a_second(10), "");
}

TEST_F(DeafnessProof, IsAboutOneLifeOfTheSender) {
  after(11, 5);
  localizer_.started_ns(7);
  EXPECT_EQ(half_a_second(5), "");
  localizer_.state(msg::kServiceFinished);
  EXPECT_EQ(after(10, 5), "") << "a replay that has ended";
}

}  // namespace
}  // namespace topogeo::messaging
