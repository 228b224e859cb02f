// A navigator with a goal holds the robot after an operator's stop, and after its start until no
// stop can have been missed.
#include "navigator/operator_stop_input.hpp"

#include <cstdint>
#include <functional>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/writer.hpp"

#include "messaging/fixture.hpp"
#include "waiting.hpp"

namespace topogeo::navigator {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kStop = 7;
constexpr std::int64_t kNow_ns = 1'000'000'000;  // of the sensors

service::Setup navigator_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "navigator";
  setup.options.partition = partition;
  return setup;
}

msg::BaseStatus base_status(msg::BaseState state, std::uint64_t stop_count) {
  auto status = messaging::message<msg::BaseStatus>();
  status.state(state);
  status.stop_count(stop_count);
  return status;
}

class OperatorStopInputTest : public testing::Test {
 protected:
  OperatorStopInputTest() {
    navigator_.set_goal({1, false});
    navigator_.add(navigation::OdometrySample{kNow_ns, geometry::Pose2{}});
  }
  /// The reason why the navigator holds the robot.
  std::string reason() {
    navigator_.step(kNow_ns);
    return navigator_.status().message;
  }
  [[nodiscard]] bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_in_loop(service_.loop(), what, condition);
  }
  void give(messaging::Writer<msg::BaseCommand>& page, msg::BaseCommandKind kind,
            std::uint64_t number) {
    auto order = messaging::message<msg::BaseCommand>();
    order.kind(kind);
    order.stop_count(number);
    ASSERT_TRUE(run_until("the navigator", [&] { return page.matched() > 0; }));
    ASSERT_TRUE(page.write(order));
  }
  [[nodiscard]] bool is_stopped() {
    return reason().find("stopped by an operator") != std::string::npos;
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{navigator_setup(partition_)};
  navigation::Navigator navigator_{navigation::NavigatorConfig()};
  OperatorStopInput stop_{service_, {}, navigator_, 0, [] {}};
  messaging::Participant participant_{messaging::options_in(partition_)};
  messaging::Writer<msg::BaseCommand> page_{participant_};
  messaging::Writer<msg::BaseCommand> other_page_{participant_};
};

TEST_F(OperatorStopInputTest, StandsAtFirstForAStopThatItMayHaveMissed) {
  EXPECT_THAT(reason(), HasSubstr("waits for an operator's stop"));
  stop_.check(StopWait::kLongest_ns - 1);
  EXPECT_THAT(reason(), HasSubstr("waits for an operator's stop"));
  stop_.check(StopWait::kLongest_ns);
  EXPECT_THAT(reason(), Not(HasSubstr("stop")));
}

TEST_F(OperatorStopInputTest, ABaseThatReportsItsStateEndsTheWait) {
  stop_.take(base_status(msg::kBaseReady, kStop));
  EXPECT_THAT(reason(), Not(HasSubstr("stop")));
}

// Another page releases by the count of the base, as `topogeo base reset` does.
TEST_F(OperatorStopInputTest, TheWordOfAnOfflineBaseReleases) {
  constexpr std::uint64_t kCount = 30;
  ASSERT_NO_FATAL_FAILURE(give(page_, msg::kBaseHalt, kStop));
  ASSERT_TRUE(run_until("the stop", [&] { return is_stopped(); }));
  stop_.take(base_status(msg::kBaseOffline, kCount));
  EXPECT_TRUE(is_stopped());
  ASSERT_NO_FATAL_FAILURE(give(other_page_, msg::kBaseReset, kCount));
  EXPECT_TRUE(run_until("the release", [&] { return !is_stopped(); }));
}

TEST_F(OperatorStopInputTest, AnOrderEndsTheWait) {
  ASSERT_NO_FATAL_FAILURE(give(page_, msg::kBaseHalt, kStop));
  ASSERT_TRUE(run_until("the stop", [&] { return is_stopped(); }));
  ASSERT_NO_FATAL_FAILURE(give(page_, msg::kBaseReset, kStop));
  ASSERT_TRUE(run_until("the release", [&] { return !is_stopped(); }));
  EXPECT_THAT(reason(), Not(HasSubstr("stop")));
}

}  // namespace
}  // namespace topogeo::navigator
