// The operator's stop when the base of another robot is connected before the robot's own, and
// manual driving commands.
#include "orders/manual_drive_sender.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <gmock/gmock.h>

#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"

#include "channels/event_log.hpp"
#include "messaging/fixture.hpp"
#include "orders/manual_drive_thread.hpp"
#include "waiting.hpp"

namespace topogeo::web {
namespace {

service::Setup page_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

class ManualDriveSenderTest : public testing::Test {
 protected:
  ManualDriveSenderTest() {
    service_.subscribe<msg::BaseStatus>([this](const msg::BaseStatus&) { base_noted_ = true; });
  }
  [[nodiscard]] bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_for(what, condition,
                          [&] { service_.loop().run_for(std::chrono::milliseconds(5)); });
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{page_setup(partition_)};
  ChannelHub hub_;
  EventLog events_{hub_};
  Tally tally_;
  int first_ = 0;
  ManualDriveSender hand_{service_.loop(), service_, hub_,
                          events_,         tally_,   {[this] { ++first_; }, [](const char*) {}}};
  bool base_noted_ = false;
  messaging::Participant base_{messaging::options_in(partition_)};
  messaging::Participant other_{messaging::options_in(partition_)};
};

TEST_F(ManualDriveSenderTest, AStopReachesABaseThatIsConnectedLate) {
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

/// A base with a writer of its own, as each start of a gateway has one.
class LivingBase {
 public:
  explicit LivingBase(const std::string& partition)
      : participant_(messaging::options_in(partition)),
        commands_(participant_),
        statuses_(participant_) {}

  [[nodiscard]] bool connected() const {
    return commands_.matched() > 0 && statuses_.matched() > 0;
  }
  void report(msg::BaseState state, std::uint64_t stop_count = 1) {
    auto status = messaging::message<msg::BaseStatus>();
    status.state(state);
    status.stop_count(stop_count);
    static_cast<void>(statuses_.write(status));
  }
  int halts() {
    commands_.take([&](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
      if (info.valid && command.kind() == msg::kBaseHalt) ++halts_;
      if (info.valid && command.kind() == msg::kBaseReset) released_ = command.stop_count();
    });
    return halts_;
  }
  /// The stop that the last reset names; 0: none.
  std::uint64_t released() {
    static_cast<void>(halts());
    return released_;
  }

 private:
  messaging::Participant participant_;
  messaging::Reader<msg::BaseCommand> commands_;
  messaging::Writer<msg::BaseStatus> statuses_;
  int halts_ = 0;
  std::uint64_t released_ = 0;
};

class ManualDriveSenderStop : public ManualDriveSenderTest {
 protected:
  /// Stops the base while it moves.
  [[nodiscard]] bool stop(LivingBase& base) {
    return run_until("a base", [&] { return base.connected(); }) &&
           run_until("the stop at the base", [&] {
             base.report(msg::kBaseMoving);
             return base_noted_ && hand_.stop() && base.halts() > 0;
           });
  }
};

TEST_F(ManualDriveSenderStop, HoldsForAGatewayThatStartsAgain) {
  {
    LivingBase base(partition_);
    ASSERT_TRUE(stop(base));
    base.report(msg::kBaseHalted);
    base.report(msg::kBaseOffline);
    base_noted_ = false;
    ASSERT_TRUE(run_until("the last status", [&] { return base_noted_; }));
  }
  LivingBase again(partition_);
  ASSERT_TRUE(run_until("the gateway that has started again", [&] { return again.connected(); }));
  EXPECT_TRUE(run_until("the stop at its base", [&] {
    again.report(msg::kBaseReady);
    return again.halts() > 0;
  }));
}

TEST_F(ManualDriveSenderStop, ThatAnotherOperatorHasReleasedIsOver) {
  LivingBase base(partition_);
  ASSERT_TRUE(stop(base));
  base.report(msg::kBaseHalted);
  base.report(msg::kBaseReady);
  const auto noted = [&] {
    base_noted_ = false;
    base.report(msg::kBaseReady);
    return run_until("a later status", [&] { return base_noted_; });
  };
  ASSERT_TRUE(noted() && noted() && noted());
  const int halts = base.halts();
  ASSERT_TRUE(noted() && noted());
  EXPECT_EQ(base.halts(), halts);
}

TEST_F(ManualDriveSenderStop, IsNamedByTheRelease) {
  constexpr std::uint64_t kStop = 7;
  LivingBase base(partition_);
  ASSERT_TRUE(stop(base));
  EXPECT_TRUE(run_until("a release after the report of the stop", [&] {
    base.report(msg::kBaseHalted, kStop);
    static_cast<void>(hand_.release_stop());
    return base.released() == kStop;
  }));
}

TEST_F(ManualDriveSenderStop, IsReleasedOnlyWhenTheBaseConfirmsIt) {
  using Outcome = UnconfirmedRelease::Outcome;
  constexpr std::uint64_t kStop = 7;
  const auto first_outcome_of = [&](msg::BaseState state, std::uint64_t stop_count) {
    LivingBase base(partition_);
    EXPECT_TRUE(stop(base));
    for (int i = 0; i < 3; ++i) {
      base_noted_ = false;
      base.report(msg::kBaseHalted, kStop);
      EXPECT_TRUE(run_until("the report of the stop", [&] { return base_noted_; }));
    }
    std::optional<Outcome> outcome;
    EXPECT_EQ(hand_.release_stop([&](Outcome found) { outcome = found; }),
              ManualDriveSender::Release::kSent);
    EXPECT_EQ(outcome, std::nullopt);
    EXPECT_TRUE(run_until("the outcome", [&] {
      base.report(state, stop_count);
      return outcome.has_value();
    }));
    hand_.forget_release();
    return outcome;
  };
  // If the machine stands still for a second, the outcome is that nothing has confirmed it.
  const auto outcome_of = [&](msg::BaseState state, std::uint64_t stop_count) {
    std::optional<Outcome> outcome = Outcome::kUnconfirmed;
    while (outcome == Outcome::kUnconfirmed && !HasFailure()) {
      outcome = first_outcome_of(state, stop_count);
    }
    return outcome;
  };
  const auto events = [&] { return *hub_.update(Channel::kEvents, 0).text; };
  EXPECT_EQ(outcome_of(msg::kBaseHalted, kStop + 1), Outcome::kRefused);
  EXPECT_THAT(events(), testing::Not(testing::HasSubstr("released by the operator")));
  EXPECT_THAT(events(), testing::HasSubstr("it was stopped again meanwhile"));
  EXPECT_EQ(outcome_of(msg::kBaseReady, kStop), Outcome::kReleased);
  EXPECT_THAT(events(), testing::HasSubstr("released by the operator"));
}

TEST(ManualDriveThread, AReleaseThatWaitedDoesNotUndoALaterStop) {
  service::Service service(page_setup(messaging::random_partition()));
  ChannelHub hub;
  EventLog events(hub);
  Tally tally;
  ManualDriveThread hand(service, hub, events, tally, {[] {}, [](const char*) {}});
  std::promise<unsigned> stopped;
  std::promise<unsigned> waited;
  std::promise<unsigned> released;
  const std::uint64_t before = hand.stops();
  // 503: no base and no navigator is connected, but the order was carried out.
  hand.stop([&](const Answer& answer) { stopped.set_value(answer.status); });
  EXPECT_EQ(stopped.get_future().get(), 503U);
  hand.release_stop(before, [&](const Answer& answer) { waited.set_value(answer.status); });
  EXPECT_EQ(waited.get_future().get(), 409U);
  // No base reports the stop, so it was kept here.
  hand.release_stop(hand.stops(), [&](const Answer& answer) { released.set_value(answer.status); });
  EXPECT_EQ(released.get_future().get(), 202U);
  std::promise<unsigned> nothing;
  hand.release_stop(hand.stops(), [&](const Answer& answer) { nothing.set_value(answer.status); });
  EXPECT_EQ(nothing.get_future().get(), 503U) << "there is neither a base nor a stop";
}

TEST(ManualDriveThread, AStopThatOnlyANavigatorHearsIsKept) {
  std::list<std::promise<Answer>> answers;
  const std::string partition = messaging::random_partition();
  service::Service service(page_setup(partition));
  ChannelHub hub;
  EventLog events(hub);
  Tally tally;
  ManualDriveThread hand(service, hub, events, tally, {[] {}, [](const char*) {}});
  const messaging::Participant navigator(messaging::options_in(partition));
  const messaging::Reader<msg::BaseCommand> orders(navigator);
  messaging::Writer<msg::NavigatorStatus> statuses(navigator);
  std::string body;
  ASSERT_TRUE(test::wait_for(
      "a stop that the navigator hears",
      [&] {
        static_cast<void>(statuses.write(messaging::message<msg::NavigatorStatus>()));
        std::promise<Answer>& stopped = answers.emplace_back();
        hand.stop([&stopped](const Answer& answer) { stopped.set_value(answer); });
        const Answer answer = stopped.get_future().get();
        body = answer.body;
        return answer.status == 202U;
      },
      [] {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));  // between two attempts
      }));
  EXPECT_THAT(body, testing::HasSubstr("this service and the navigator hold the robot"));
}

std::int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TEST_F(ManualDriveSenderTest, AnOrderThatWaitedIsRefused) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  hand_.drive(1, {0.3, 0.0}, now_ns() - kSecond_ns);
  EXPECT_FALSE(hand_.is_held());
  EXPECT_EQ(first_, 0);
  EXPECT_EQ(tally_.counts().at("refused: late"), 1U);
}

TEST_F(ManualDriveSenderTest, AStopSendsZerosAtOnce) {
  // Commands are repeated, because a slow machine considers the first ones late.
  ASSERT_TRUE(run_until("somebody drives", [&] {
    hand_.drive(1, {0.3, 0.0}, now_ns());
    return first_ > 0;
  }));
  const std::uint64_t commands = tally_.counts().at("commands");
  EXPECT_FALSE(hand_.stop()) << "no base hears it";
  EXPECT_FALSE(hand_.is_held());
  EXPECT_EQ(tally_.counts().at("commands"), commands + 1);
}

// A base of ROS takes no order to halt: an order of another page would move it again.
TEST_F(ManualDriveSenderTest, OrdersAfterAStopAreRefusedUntilTheRelease) {
  const auto shown = [&] { return *hub_.update(Channel::kDrive, 0).text; };
  EXPECT_FALSE(hand_.stop()) << "no base hears it";
  EXPECT_THAT(shown(), testing::HasSubstr("\"stopped\":true"));
  hand_.drive(1, {0.3, 0.0}, now_ns());
  EXPECT_FALSE(hand_.is_held());
  EXPECT_EQ(first_, 0);
  EXPECT_EQ(hand_.release_stop(), ManualDriveSender::Release::kHeldHere);
  EXPECT_THAT(shown(), testing::Not(testing::HasSubstr("stopped")));
  // Commands are repeated, because a slow machine considers the first ones late.
  EXPECT_TRUE(run_until("somebody drives", [&] {
    hand_.drive(1, {0.3, 0.0}, now_ns());
    return first_ > 0;
  }));
}

/// A page of a robot whose base reports nothing, as one of ROS. A navigator takes orders to the
/// base; another program gives them.
class BesideSilentBase : public testing::Test {
 protected:
  static constexpr std::uint64_t kOtherStop = 7;

  BesideSilentBase() { begin(); }
  ~BesideSilentBase() override { std::filesystem::remove(memory_); }

  /// Starts the process of the page, after the end of the one before.
  void begin() {
    hand_.reset();
    service_.reset();
    hub_.emplace();
    events_.emplace(*hub_);
    service_.emplace(page_setup(partition_));
    hand_.emplace(service_->loop(), *service_, *hub_, *events_, tally_,
                  ManualDriveSender::Hooks{[this] { ++first_; }, [](const char*) {}}, memory_);
  }
  [[nodiscard]] bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_in_loop(service_->loop(), what, condition);
  }
  /// Runs until the newest order at the navigator is of that kind.
  [[nodiscard]] bool navigator_gets(msg::BaseCommandKind kind) {
    return run_until("an order at the navigator", [&] {
      static_cast<void>(navigator_->statuses.write(messaging::message<msg::NavigatorStatus>()));
      navigator_->orders.take(
          [&](const msg::BaseCommand& order, const messaging::SampleInfo& info) {
            if (info.valid) newest_ = order;
          });
      return newest_ && newest_->kind() == kind;
    });
  }
  void give(msg::BaseCommandKind kind, std::uint64_t number = kOtherStop) {
    auto order = messaging::message<msg::BaseCommand>();
    messaging::set_client_id(order, "other");
    order.kind(kind);
    order.stop_count(number);
    // The navigator and the page.
    ASSERT_TRUE(run_until("both readers", [&] { return given_.matched() > 1; }));
    ASSERT_TRUE(given_.write(order));
  }
  [[nodiscard]] bool is_stopped() {
    if (hub_->version(Channel::kDrive) == 0) return false;
    return hub_->update(Channel::kDrive, 0).text->find("\"stopped\":true") != std::string::npos;
  }
  /// Whether an order to drive by hand is refused because of a stop. A slow machine may consider
  /// the order late.
  [[nodiscard]] bool refuses_to_drive() {
    const auto refused = [&] {
      const auto counts = tally_.counts();
      const auto found = counts.find("refused: stopped");
      return found == counts.end() ? std::uint64_t{0} : found->second;
    };
    const std::uint64_t before = refused();
    const int first = first_;
    EXPECT_TRUE(run_until("an order that is taken or refused", [&] {
      hand_->drive(1, {0.3, 0.0}, now_ns());
      return refused() > before || first_ > first;
    }));
    return refused() > before;
  }

  std::string partition_ = messaging::random_partition();
  const std::filesystem::path memory_ = std::filesystem::path(testing::TempDir()) / partition_;
  std::optional<ChannelHub> hub_;
  std::optional<EventLog> events_;
  Tally tally_;
  int first_ = 0;
  std::optional<service::Service> service_;
  std::optional<ManualDriveSender> hand_;
  /// A navigator that takes orders to the base.
  struct Navigator {
    explicit Navigator(const std::string& partition)
        : participant(messaging::options_in(partition)) {}
    messaging::Participant participant;
    messaging::Reader<msg::BaseCommand> orders{participant};
    messaging::Writer<msg::NavigatorStatus> statuses{participant};
  };
  std::optional<Navigator> navigator_{std::in_place, partition_};
  messaging::Participant other_{messaging::options_in(partition_)};
  messaging::Writer<msg::BaseCommand> given_{other_};
  std::optional<msg::BaseCommand> newest_;  // at the navigator
};

TEST_F(BesideSilentBase, AStopOutlivesThePage) {
  EXPECT_FALSE(hand_->stop()) << "no base hears it";
  begin();
  EXPECT_TRUE(is_stopped());
  EXPECT_TRUE(refuses_to_drive());
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kHeldHere);
  EXPECT_FALSE(refuses_to_drive());
  begin();
  EXPECT_FALSE(is_stopped()) << "the stop was released";
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kUnheard);
}

TEST_F(BesideSilentBase, ANavigatorThatConnectsLaterGetsTheStopAndItsRelease) {
  navigator_.reset();
  EXPECT_FALSE(hand_->stop());
  begin();
  navigator_.emplace(partition_);
  ASSERT_TRUE(navigator_gets(msg::kBaseHalt));
  const std::uint64_t stop = newest_->stop_count();
  EXPECT_NE(stop, 0U);
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kHeldHere);
  ASSERT_TRUE(navigator_gets(msg::kBaseReset));
  EXPECT_EQ(newest_->stop_count(), stop);
  newest_.reset();
  begin();
  ASSERT_TRUE(navigator_gets(msg::kBaseReset)) << "it may have started after the release";
  EXPECT_EQ(newest_->stop_count(), stop);
}

TEST_F(BesideSilentBase, AStopOfAnotherProgramHoldsUntilItsRelease) {
  ASSERT_NO_FATAL_FAILURE(give(msg::kBaseHalt));
  ASSERT_TRUE(run_until("the stop", [&] { return is_stopped(); }));
  EXPECT_TRUE(refuses_to_drive());
  ASSERT_NO_FATAL_FAILURE(give(msg::kBaseReset));
  ASSERT_TRUE(run_until("the release", [&] { return !is_stopped(); }));
  EXPECT_FALSE(refuses_to_drive());
}

TEST_F(BesideSilentBase, AStopOfAnotherProgramCanBeReleasedHere) {
  ASSERT_NO_FATAL_FAILURE(give(msg::kBaseHalt));
  ASSERT_TRUE(run_until("the stop", [&] { return is_stopped(); }));
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kHeldHere);
  ASSERT_TRUE(navigator_gets(msg::kBaseReset));
  EXPECT_EQ(newest_->stop_count(), kOtherStop);
}

// The robot may have a base of ROS from now on.
TEST_F(BesideSilentBase, AStopHoldsWhenTheGatewayHasGone) {
  {
    LivingBase gateway(partition_);
    ASSERT_TRUE(run_until("a gateway that hears the stop", [&] {
      gateway.report(msg::kBaseMoving);
      return hand_->stop();
    }));
    ASSERT_TRUE(run_until("the gateway to decide about it", [&] { return !is_stopped(); }));
  }
  EXPECT_TRUE(run_until("the stop to be kept here", [&] { return is_stopped(); }));
  EXPECT_TRUE(refuses_to_drive());
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kHeldHere);
}

// A navigator that has started again knows the stop by its number alone.
TEST_F(BesideSilentBase, AReleaseOfAGatewayByAnotherProgramIsAnEvent) {
  const auto events = [&] { return *hub_->update(Channel::kEvents, 0).text; };
  ASSERT_NO_FATAL_FAILURE(give(msg::kBaseHalt));
  ASSERT_TRUE(run_until("the stop", [&] { return is_stopped(); }));
  EXPECT_THAT(events(), testing::HasSubstr("stopped by other"));
  LivingBase gateway(partition_);
  ASSERT_TRUE(run_until("the gateway to decide about it", [&] {
    gateway.report(msg::kBaseHalted);
    return !is_stopped();
  }));
  EXPECT_THAT(events(), testing::Not(testing::HasSubstr("released by other")));
  // One after the other, and again: the page may hear the gateway before the other program.
  int step = 0;
  EXPECT_TRUE(run_until("the event", [&] {
    if (step == 0) gateway.report(msg::kBaseHalted);
    if (step == 1) give(msg::kBaseReset);
    if (step == 2) gateway.report(msg::kBaseReady);
    step = (step + 1) % 3;
    return events().find("released by other") != std::string::npos;
  }));
}

TEST_F(BesideSilentBase, AStopThatAnotherProgramHasReleasedHaltsNoLaterGateway) {
  constexpr int kMany = 30;  // the page has time to send a halt
  EXPECT_FALSE(hand_->stop());
  ASSERT_TRUE(navigator_gets(msg::kBaseHalt));
  ASSERT_NO_FATAL_FAILURE(give(msg::kBaseReset, newest_->stop_count()));
  ASSERT_TRUE(run_until("the release", [&] { return !is_stopped(); }));
  int statuses = 0;
  service_->subscribe<msg::BaseStatus>([&](const msg::BaseStatus&) { ++statuses; });
  LivingBase gateway(partition_);
  ASSERT_TRUE(run_until("statuses of a gateway", [&] {
    if (gateway.connected()) gateway.report(msg::kBaseReady);
    return statuses >= kMany;
  }));
  // An order that follows a halt on the same link.
  ASSERT_TRUE(run_until("a later order", [&] {
    static_cast<void>(hand_->release_stop());
    return gateway.released() != 0;
  }));
  EXPECT_EQ(gateway.halts(), 0);
}

TEST_F(BesideSilentBase, TheReleaseNamesAStopThatTheBaseHasNotReported) {
  constexpr std::uint64_t kCount = 30;
  LivingBase gateway(partition_);
  ASSERT_TRUE(run_until("a gateway that hears the stop", [&] {
    gateway.report(msg::kBaseOffline, kCount);
    return hand_->stop();
  }));
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kSent);
  EXPECT_TRUE(run_until("a release that names the stop, not the count of the base", [&] {
    const std::uint64_t named = gateway.released();
    return named != 0 && named != kCount;
  }));
}

TEST_F(BesideSilentBase, TheChannelShowsThatAGatewayDecides) {
  ASSERT_NO_FATAL_FAILURE(give(msg::kBaseHalt));
  ASSERT_TRUE(run_until("the stop", [&] { return is_stopped(); }));
  LivingBase gateway(partition_);
  EXPECT_TRUE(run_until("the gateway to decide about it", [&] {
    gateway.report(msg::kBaseHalted);
    return !is_stopped();
  }));
}

// A bridge to ROS that starts after the stop must end the last velocity of the one before.
TEST_F(BesideSilentBase, ZerosAreRepeatedDuringAStop) {
  const auto commands = [&] {
    const auto counts = tally_.counts();
    const auto found = counts.find("commands");
    return found == counts.end() ? std::uint64_t{0} : found->second;
  };
  EXPECT_FALSE(hand_->stop());
  const std::uint64_t before = commands();
  EXPECT_TRUE(run_until("three more commands", [&] { return commands() >= before + 3; }));
  EXPECT_EQ(hand_->release_stop(), ManualDriveSender::Release::kHeldHere);
}

TEST_F(ManualDriveSenderTest, NothingMovesBeforeItIsKnownWhereItMayNot) {
  const auto shown = [&] { return *hub_.update(Channel::kDrive, 0).text; };
  // Commands are repeated, because a slow machine considers the first ones late.
  ASSERT_TRUE(run_until("somebody drives", [&] {
    hand_.drive(1, {0.3, 0.0}, now_ns());
    return first_ > 0;
  }));
  EXPECT_THAT(shown(), testing::HasSubstr("waiting for the drawing"));
  ASSERT_TRUE(run_until("the guard alone decides", [&] {
    hand_.drive(1, {0.3, 0.0}, now_ns());
    hand_.keep_off(std::make_shared<const navigation::DrawnLimits>());
    hand_.drive(1, {0.3, 0.0}, now_ns());
    return shown().find("waiting for the drawing") == std::string::npos;
  }));
}

}  // namespace
}  // namespace topogeo::web
