// The loop calls handlers in its own thread, in order, and ends on request.
#include <chrono>
#include <csignal>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

#include "topogeo/messaging/signal_stop.hpp"

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

using namespace std::chrono_literals;

TEST(EventLoop, StopsFromAnotherThread) {
  EventLoop loop;
  std::promise<void> runs;
  loop.post([&] { runs.set_value(); });
  std::thread stopper([&] {
    runs.get_future().wait();
    loop.stop();
  });
  EXPECT_TRUE(run_to_stop(loop));
  stopper.join();
}

TEST(EventLoop, StopBeforeRunIsNotLost) {
  EventLoop loop;
  loop.stop();
  EXPECT_TRUE(run_to_stop(loop));
  EXPECT_FALSE(loop.run_for(1ms));  // and counts once
}

TEST(EventLoop, StopsOnASignal) {
  EventLoop loop;
  {
    const SignalStop signals([&](int) { loop.stop(); });
    EXPECT_EQ(SignalStop::received(), 0);
    EXPECT_THROW(SignalStop([](int) {}), std::logic_error);
    loop.call_after(20ms, [] { ::raise(SIGTERM); });
    EXPECT_TRUE(run_to_stop(loop));
  }
  EXPECT_EQ(SignalStop::received(), SIGTERM);
}

/// The order in which three timers run; empty when the machine paused, while they were set, for
/// longer than their times are apart, because the order is then undefined.
std::vector<int> order_of_timers() {
  EventLoop loop;
  std::vector<int> order;
  const auto start = std::chrono::steady_clock::now();
  loop.call_after(30ms, [&] {
    order.push_back(3);
    loop.stop();
  });
  loop.call_after(10ms, [&] { order.push_back(1); });
  const auto cancelled = loop.call_after(15ms, [&] { order.push_back(99); });
  loop.call_after(20ms, [&] { order.push_back(2); });
  loop.cancel_timer(cancelled);
  const bool at_once = std::chrono::steady_clock::now() - start < 10ms;
  EXPECT_TRUE(run_to_stop(loop));
  return at_once ? order : std::vector<int>();
}

TEST(EventLoop, TimersRunInOrderOfTheirTimes) {
  std::vector<int> order;
  ASSERT_TRUE(test::wait_for("timers that are set at once", [&] {
    order = order_of_timers();
    return !order.empty();
  }));
  EXPECT_EQ(order, (std::vector<int>{1, 2, 3}));
}

TEST(EventLoop, ReportsHowLateItsTimersWere) {
  EventLoop loop;
  EXPECT_EQ(loop.take_timer_delay(), 0ms);
  using Clock = std::chrono::steady_clock;
  const auto before = Clock::now();
  std::chrono::nanoseconds longest{};
  loop.call_after(0ms, [&] {
    longest = Clock::now() - before;
    loop.stop();
  });
  // Posted handlers come before the timers.
  loop.post([start = Clock::now()] {
    while (Clock::now() < start + 20ms) continue;
  });
  EXPECT_TRUE(loop.run_for(test::hang_limit()));
  const auto delay = loop.take_timer_delay();
  EXPECT_GE(delay, 20ms);
  EXPECT_LE(delay, longest);
  EXPECT_EQ(loop.take_timer_delay(), 0ms) << "it was taken";
}

TEST(EventLoop, PeriodicTimerMayCancelItself) {
  EventLoop loop;
  int ticks = 0;
  std::uint64_t timer = 0;
  timer = loop.add_timer(1ms, [&] {
    if (++ticks == 3) {
      loop.cancel_timer(timer);
      loop.call_after(20ms, [&] { loop.stop(); });
    }
  });
  EXPECT_TRUE(run_to_stop(loop));
  EXPECT_EQ(ticks, 3);
  EXPECT_THROW(loop.add_timer(0ms, [] {}), std::invalid_argument);
}

TEST(EventLoop, PostedHandlersRunInTheLoopsThread) {
  EventLoop loop;
  std::thread::id where;
  std::thread poster([&] {
    loop.post([&] {
      where = std::this_thread::get_id();
      loop.stop();
    });
  });
  EXPECT_TRUE(run_to_stop(loop));
  poster.join();
  EXPECT_EQ(where, std::this_thread::get_id());
}

TEST(EventLoop, ExceptionOfAHandlerLeavesRun) {
  EventLoop loop;
  loop.post([] { throw std::runtime_error("handler"); });
  EXPECT_THROW(loop.run(), std::runtime_error);
}

class LoopDelivery : public TwoParticipants {};

TEST_F(LoopDelivery, HandlersGetSamplesAndDisposalsOfSeveralReaders) {
  Writer<msg::Goal> goals(sender_);
  Writer<msg::Route> routes(sender_);
  const Reader<msg::Goal> goal_reader(receiver_);
  const Reader<msg::Route> route_reader(receiver_);
  EventLoop loop;
  std::vector<std::string> seen;
  loop.add<msg::Goal>(
      goal_reader,
      [&](const msg::Goal& goal, const SampleInfo&) {
        seen.push_back("goal " + std::to_string(goal.goal_id()));
        EXPECT_TRUE(routes.write(message<msg::Route>()));
      },
      [&](const SampleInfo&) {
        seen.emplace_back("goal gone");
        loop.stop();
      });
  loop.add<msg::Route>(route_reader, [&](const msg::Route&, const SampleInfo&) {
    seen.emplace_back("route");
    goals.dispose(message<msg::Goal>());
  });
  auto goal = message<msg::Goal>();
  goal.goal_id(8);
  ASSERT_TRUE(goals.write(goal));
  EXPECT_TRUE(run_to_stop(loop));
  EXPECT_EQ(seen, (std::vector<std::string>{"goal 8", "route", "goal gone"}));
}

// A stranger may send such a message.
TEST_F(LoopDelivery, AMessageThatItsHandlerRefusesIsAnEventAndTheNextOneComes) {
  Writer<msg::MatchTasks> writer(sender_);
  const Reader<msg::MatchTasks> reader(receiver_);
  ASSERT_TRUE(wait_for_peers(writer));
  EventLoop loop;
  std::vector<std::string> refused;
  loop.on_event([&](const Event& event) {
    if (event.kind != EventKind::kInvalidSample) return;
    refused.push_back(event.detail);
    EXPECT_EQ(event.topic, kMatchTasks);
    EXPECT_TRUE(writer.write(message<msg::MatchTasks>(1)));
  });
  loop.add<msg::MatchTasks>(reader, [&](const msg::MatchTasks& task, const SampleInfo&) {
    if (task.sequence_number() == 0) throw std::invalid_argument("x_m is nan");
    loop.stop();
  });
  ASSERT_TRUE(writer.write(message<msg::MatchTasks>(0)));
  EXPECT_TRUE(run_to_stop(loop));
  EXPECT_EQ(refused, std::vector<std::string>{"x_m is nan"});
}

TEST_F(LoopDelivery, NothingIsLostBetweenBatches) {
  constexpr std::uint64_t kTasks = 100;  // several batches
  Writer<msg::MatchTasks> writer(sender_);
  const Reader<msg::MatchTasks> reader(receiver_);
  ASSERT_TRUE(wait_for_peers(writer));
  for (std::uint64_t i = 0; i < kTasks; ++i) ASSERT_TRUE(writer.write(message<msg::MatchTasks>(i)));
  EventLoop loop;
  std::uint64_t expected = 0;
  loop.add<msg::MatchTasks>(reader, [&](const msg::MatchTasks& task, const SampleInfo&) {
    EXPECT_EQ(task.sequence_number(), expected);
    if (++expected == kTasks) loop.stop();
  });
  EXPECT_TRUE(run_to_stop(loop));
  EXPECT_EQ(expected, kTasks);
}

TEST_F(LoopDelivery, StopInAHandlerLeavesTheRestForTheNextRun) {
  Writer<msg::MatchTasks> writer(sender_);
  const Reader<msg::MatchTasks> reader(receiver_);
  ASSERT_TRUE(wait_for_peers(writer));
  for (std::uint64_t i = 0; i < 3; ++i) ASSERT_TRUE(writer.write(message<msg::MatchTasks>(i)));
  ASSERT_TRUE(wait_for_acknowledgments(writer));
  EventLoop loop;
  int handled = 0;
  loop.add<msg::MatchTasks>(reader, [&](const msg::MatchTasks&, const SampleInfo&) {
    ++handled;
    loop.stop();
  });
  for (int run = 1; run <= 3; ++run) {
    EXPECT_TRUE(run_to_stop(loop));
    EXPECT_EQ(handled, run);
  }
}

}  // namespace
}  // namespace topogeo::messaging
