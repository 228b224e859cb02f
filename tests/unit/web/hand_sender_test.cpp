// The operator's stop when the base of another robot is connected before the robot's own, and
// manual driving commands.
#include "orders/hand_sender.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"

#include "channels/event_log.hpp"
#include "messaging/fixture.hpp"
#include "waiting.hpp"

namespace topogeo::web {
namespace {

service::Setup page_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

class HandSenderTest : public testing::Test {
 protected:
  HandSenderTest() {
    service_.subscribe<msg::BaseStatus>([this](const msg::BaseStatus&) { base_noted_ = true; });
  }
  [[nodiscard]] bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_for(what, condition,
                          [&] { service_.loop().run_for(std::chrono::milliseconds(5)); });
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{page_setup(partition_)};
  Board board_;
  EventLog events_{board_};
  Tally tally_;
  int first_ = 0;
  HandSender hand_{service_.loop(), service_, board_,
                   events_,         tally_,   {[this] { ++first_; }, [](const char*) {}}};
  bool base_noted_ = false;
  messaging::Participant base_{messaging::options_in(partition_)};
  messaging::Participant other_{messaging::options_in(partition_)};
};

TEST_F(HandSenderTest, AStopReachesABaseThatIsConnectedLate) {
  const messaging::Reader<msg::BaseCommand> other_base(other_);
  messaging::Writer<msg::BaseStatus> statuses(base_);
  ASSERT_TRUE(run_until("another base and the status of the own one",
                        [&] { return other_base.matched() > 0 && statuses.matched() > 0; }));
  ASSERT_TRUE(statuses.write(messaging::message<msg::BaseStatus>()));
  ASSERT_TRUE(run_until("the status", [&] { return base_noted_; }));
  EXPECT_FALSE(hand_.stop()) << "another base hears it, the own one does not";
  messaging::Reader<msg::BaseCommand> commands(base_);
  std::optional<msg::BaseCommandKind> kind;
  EXPECT_TRUE(run_until("the stop at the base", [&] {
    commands.take([&](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
      if (info.valid) kind = command.kind();
    });
    return kind.has_value();
  }));
  EXPECT_EQ(kind, msg::kBaseHalt);
  EXPECT_TRUE(hand_.stop());
}

std::int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TEST_F(HandSenderTest, AnOrderThatWaitedIsRefused) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  hand_.drive(1, {0.3, 0.0}, now_ns() - kSecond_ns);
  EXPECT_FALSE(hand_.is_held());
  EXPECT_EQ(first_, 0);
  EXPECT_EQ(tally_.counts().at("refused: late"), 1U);
}

TEST_F(HandSenderTest, NothingMovesBeforeItIsKnownWhereItMayNot) {
  const auto shown = [&] { return *board_.update(Channel::kDrive, 0).text; };
  // Commands are repeated, because a slow machine considers the first ones late.
  ASSERT_TRUE(run_until("somebody drives", [&] {
    hand_.drive(1, {0.3, 0.0}, now_ns());
    return first_ > 0;
  }));
  EXPECT_THAT(shown(), testing::HasSubstr("is read first"));
  ASSERT_TRUE(run_until("the guard alone decides", [&] {
    hand_.drive(1, {0.3, 0.0}, now_ns());
    hand_.keep_off(std::make_shared<const navigation::DrawnLimits>());
    hand_.drive(1, {0.3, 0.0}, now_ns());
    return shown().find("is read first") == std::string::npos;
  }));
}

}  // namespace
}  // namespace topogeo::web
