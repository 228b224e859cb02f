// Orders to a navigator that is discovered before it is connected, and to one that restarts.
#include "topogeo/service/goal_outbox.hpp"

#include <optional>
#include <vector>

#include <gmock/gmock.h>

#include "messaging/fixture.hpp"

namespace topogeo::service {
namespace {

Setup outbox_setup(const std::string& partition) {
  Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

msg::Goal order(std::uint64_t id) {
  auto message = messaging::message<msg::Goal>();
  message.goal_id(id);
  return message;
}

/// A navigator that, like the real one, takes no orders from before it was connected.
struct StandInNavigator {
  explicit StandInNavigator(const std::string& partition)
      : participant(messaging::options_in(partition)), statuses(participant) {}

  void listen() { goals.emplace(participant, messaging::ReaderOptions{.role = "request"}); }
  std::vector<std::uint64_t> take() {
    goals->take([this](const msg::Goal& goal, const messaging::SampleInfo& info) {
      if (info.valid) taken.push_back(goal.goal_id());
    });
    return taken;
  }

  messaging::Participant participant;
  messaging::Writer<msg::NavigatorStatus> statuses;
  std::optional<messaging::Reader<msg::Goal>> goals;
  std::vector<std::uint64_t> taken;
};

class GoalOutboxTest : public testing::Test {
 protected:
  GoalOutboxTest() {
    service_.subscribe<msg::NavigatorStatus>(
        [this](const msg::NavigatorStatus&, const messaging::SampleInfo& info) {
          heard_ = info.writer;
          outbox_.note_navigator(info);
        },
        {.any_robot = true});
  }
  bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_in_loop(service_.loop(), what, condition);
  }
  /// Waits until the outbox hears a navigator other than the last one.
  void hear(StandInNavigator& navigator) {
    const auto before = heard_;
    ASSERT_TRUE(run_until("a status", [&] {
      return navigator.statuses.write(messaging::message<msg::NavigatorStatus>()) &&
             heard_ != before;
    }));
  }

  std::string partition_ = messaging::random_partition();
  Service service_{outbox_setup(partition_)};
  GoalOutbox outbox_{service_};
  std::optional<messaging::Handle> heard_;
};

TEST_F(GoalOutboxTest, WaitsUntilTheNavigatorIsConnected) {
  StandInNavigator navigator(partition_);
  EXPECT_FALSE(outbox_.knows_navigator());
  hear(navigator);
  EXPECT_TRUE(outbox_.knows_navigator());
  EXPECT_TRUE(outbox_.has_navigator()) << "about to be connected";
  EXPECT_TRUE(outbox_.send(order(1)));
  EXPECT_TRUE(outbox_.send(order(2)));
  navigator.listen();
  EXPECT_TRUE(run_until("the newest goal", [&] {
    return navigator.statuses.write(messaging::message<msg::NavigatorStatus>()) &&
           !navigator.take().empty();
  }));
  EXPECT_TRUE(outbox_.has_navigator());
  EXPECT_EQ(navigator.taken, std::vector<std::uint64_t>{2});
}

TEST_F(GoalOutboxTest, TheNextNavigatorGetsNoOrderOfBefore) {
  {
    StandInNavigator gone(partition_);
    hear(gone);
    EXPECT_TRUE(outbox_.send(order(1)));
  }
  StandInNavigator next(partition_);
  next.listen();
  hear(next);
  EXPECT_TRUE(outbox_.send(order(2)));
  EXPECT_TRUE(run_until("the order to the next one", [&] {
    return next.statuses.write(messaging::message<msg::NavigatorStatus>()) && !next.take().empty();
  }));
  EXPECT_EQ(next.taken, std::vector<std::uint64_t>{2});
}

// A planner that restarts meanwhile needs the goal for the route after the pause.
TEST_F(GoalOutboxTest, AGoalStaysStoredBehindAnOrderToPause) {
  StandInNavigator navigator(partition_);
  navigator.listen();
  hear(navigator);
  EXPECT_TRUE(outbox_.send(order(1)));
  msg::Goal pause = order(0);
  pause.kind(msg::kGoalPause);
  EXPECT_TRUE(outbox_.send(pause));
  EXPECT_TRUE(run_until("goal and pause", [&] {
    return navigator.statuses.write(messaging::message<msg::NavigatorStatus>()) &&
           navigator.take().size() == 2;
  }));
  const messaging::Participant planner(messaging::options_in(partition_));
  messaging::Reader<msg::Goal> goals(planner);
  std::vector<std::uint64_t> stored;
  EXPECT_TRUE(run_until("the stored orders", [&] {
    goals.take([&](const msg::Goal& goal, const messaging::SampleInfo& info) {
      if (info.valid) stored.push_back(goal.goal_id());
    });
    return stored.size() == 2;
  }));
  EXPECT_THAT(stored, testing::UnorderedElementsAre(1U, 0U));
}

}  // namespace
}  // namespace topogeo::service
