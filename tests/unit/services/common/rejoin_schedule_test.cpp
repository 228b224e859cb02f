// The times at which a deaf service listens, reports and ends. The tests advance the time.
#include "topogeo/service/rejoin_schedule.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "topogeo/messaging/deafness.hpp"

namespace topogeo::service {
namespace {

constexpr double kTick_s = 0.2;

class RejoinScheduleTest : public ::testing::Test {
 protected:
  /// The next tick of a continuing silence.
  RejoinStep tick() {
    now_s_ += kTick_s;
    input_.silence_s += kTick_s;
    return schedule_.step(input_, now_s_);
  }
  /// Seconds of silence at which `wanted` becomes true, within `limit_s` of it.
  template <class Wanted>
  double silence_until(const Wanted& wanted, double limit_s = 10'000.0) {
    while (input_.silence_s < limit_s) {
      if (wanted(tick())) return input_.silence_s;
    }
    return limit_s;
  }

  RejoinSchedule schedule_{0};
  InputState input_{.silence_s = 0.0, .ever_came = true, .hears_sender = true, .deaf = false};
  double now_s_ = 0.0;
};

TEST_F(RejoinScheduleTest, AsksOthersWhenTheInputIsSilentForFiveSeconds) {
  const double silence_s = silence_until([](const RejoinStep& step) { return step.listen; });
  EXPECT_NEAR(silence_s, messaging::DeafnessWatch::kSilence_s, 2 * kTick_s);
  for (int i = 0; i < 1000; ++i) {
    const RejoinStep step = tick();
    EXPECT_FALSE(step.probe || step.report || step.end) << "its sender is silent, too";
  }
}

// The silence of a service that has just started counts from its start.
TEST_F(RejoinScheduleTest, ListensBeforeItProbes) {
  input_ = {.silence_s = 10.0, .ever_came = true, .hears_sender = false, .deaf = false};
  const double heard_s = 10.0 + RejoinSchedule::kListen_s / 2;
  silence_until(
      [&](const RejoinStep& step) {
        EXPECT_TRUE(step.listen);
        EXPECT_FALSE(step.probe) << input_.silence_s;
        input_.hears_sender = input_.silence_s > heard_s;
        return false;
      },
      100.0);
}

TEST_F(RejoinScheduleTest, EndsAtOnceWhenItsInputHasCeased) {
  input_.silence_s = 8.0;
  input_.deaf = true;
  const RejoinStep step = tick();
  EXPECT_TRUE(step.report);
  EXPECT_TRUE(step.end);
  EXPECT_EQ(schedule_.deaf_lives(), 1U);
}

TEST_F(RejoinScheduleTest, WaitsLongerInEachLifeThatIsDeafFromItsStart) {
  std::vector<double> waits_s;
  std::uint32_t lives = 1;
  for (int life = 0; life < 4; ++life) {
    schedule_ = RejoinSchedule(lives);
    input_ = {.silence_s = 10.0, .ever_came = false, .hears_sender = true, .deaf = true};
    waits_s.push_back(silence_until([](const RejoinStep& step) { return step.end; }) - 10.0);
    lives = schedule_.deaf_lives();
  }
  EXPECT_NEAR(waits_s[0], 60.0, 2 * kTick_s);
  for (const int life : {1, 2, 3}) EXPECT_NEAR(waits_s[life], 600.0, 2 * kTick_s) << life;
}

TEST_F(RejoinScheduleTest, ReportsOnceAMinuteWhileItWaits) {
  schedule_ = RejoinSchedule(2);
  input_ = {.silence_s = 10.0, .ever_came = false, .hears_sender = true, .deaf = true};
  int reports = 0;
  silence_until([&](const RejoinStep& step) {
    reports += step.report ? 1 : 0;
    return step.end;
  });
  EXPECT_GE(reports, 10);
  EXPECT_LE(reports, 11);
}

// A service without persistent memory must not be restarted again and again.
TEST_F(RejoinScheduleTest, WithoutAMemoryOneThatIsDeafFromItsStartWaits) {
  input_ = {.silence_s = 10.0, .ever_came = false, .hears_sender = true, .deaf = true};
  const double silence_s = silence_until([](const RejoinStep& step) { return step.end; });
  EXPECT_NEAR(silence_s, 70.0, 2 * kTick_s);
  EXPECT_EQ(schedule_.deaf_lives(), 2U);
}

TEST_F(RejoinScheduleTest, ForgetsTheLivesBeforeWhenItsInputHasCome) {
  schedule_ = RejoinSchedule(3);
  input_.ever_came = false;
  tick();
  EXPECT_EQ(schedule_.deaf_lives(), 3U);
  input_.ever_came = true;
  tick();
  EXPECT_EQ(schedule_.deaf_lives(), 0U);
}

// Each pause is as long as the silence before it, so no deafness outlasts its cause by much more.
TEST_F(RejoinScheduleTest, ProbesLessOftenTheLongerTheSenderIsNotHeard) {
  input_.hears_sender = false;
  std::vector<double> starts_s;
  bool probes = false;
  silence_until(
      [&](const RejoinStep& step) {
        if (step.probe && !probes) starts_s.push_back(input_.silence_s);
        probes = step.probe;
        return false;
      },
      4000.0);
  ASSERT_GE(starts_s.size(), 5U);
  EXPECT_NEAR(starts_s[0], messaging::DeafnessWatch::kSilence_s + RejoinSchedule::kListen_s,
              2 * kTick_s);
  for (std::size_t i = 1; i < starts_s.size(); ++i) {
    EXPECT_LE(starts_s[i], 2 * starts_s[i - 1] + RejoinSchedule::kProbe_s + 1.0) << i;
    EXPECT_GT(starts_s[i], starts_s[i - 1] + RejoinSchedule::kProbe_s) << i;
    EXPECT_LE(starts_s[i] - starts_s[i - 1],
              RejoinSchedule::kLongestPause_s + RejoinSchedule::kProbe_s + 1.0);
  }
}

TEST_F(RejoinScheduleTest, AProbeThatHearsTheSenderGoesOn) {
  input_.hears_sender = false;
  silence_until([](const RejoinStep& step) { return step.probe; });
  input_.hears_sender = true;
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(tick().probe);
  input_.silence_s = 0.0;
  EXPECT_FALSE(tick().probe) << "the input has come";
}

}  // namespace
}  // namespace topogeo::service
