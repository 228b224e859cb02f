// The timers of the middleware stay in order, no matter which of them have run.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

#include <fastdds/rtps/resources/ResourceEvent.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

#include "fast_dds/timer_waits.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;

// An explicit instantiation may name private members.
template <auto kTimer>
struct EventMembers {
  friend const rtps::TimedEventImpl* timer_of(const rtps::TimedEvent& event) {
    return event.*kTimer;
  }
};
const rtps::TimedEventImpl* timer_of(const rtps::TimedEvent& event);
template struct EventMembers<&rtps::TimedEvent::impl_>;

template <auto kActive>
struct ServiceMembers {
  friend const std::vector<rtps::TimedEventImpl*>& active(const rtps::ResourceEvent& service) {
    return service.*kActive;
  }
};
/// Pending timers, in the order in which the library checks them.
const std::vector<rtps::TimedEventImpl*>& active(const rtps::ResourceEvent& service);
template struct ServiceMembers<&rtps::ResourceEvent::active_timers_>;

}  // namespace

// NOLINTBEGIN: the names of member functions of the library, which its thread calls in turn
extern "C" void look_at_the_clock(rtps::ResourceEvent* service) __asm__(
    "_ZN8eprosima8fastrtps4rtps13ResourceEvent19update_current_timeEv");
extern "C" void run_due_timers(rtps::ResourceEvent* service) __asm__(
    "_ZN8eprosima8fastrtps4rtps13ResourceEvent16do_timer_actionsEv");
// NOLINTEND

namespace topogeo::messaging {
namespace {

constexpr std::size_t kTimers = 200;
// Far enough apart that the time between two readings of the clock does not matter; all are within
// a day, after which the library considers a timer cancelled.
constexpr double kApart_ms = 300e3;

/// Timers of a participant, run in the test's own thread.
class Timers {
 public:
  /// Each timer is due at once, and again after a multiple of kApart_ms.
  Timers() {
    std::vector<double> later_ms(kTimers);
    support::Random random(5);
    for (std::size_t k = 0; k < kTimers; ++k) {
      later_ms[k] = kApart_ms * static_cast<double>(k + 1);
      std::swap(later_ms[k], later_ms[random.below(k + 1)]);
    }
    for (std::size_t k = 0; k < kTimers; ++k) {
      timers_.push_back(std::make_unique<rtps::TimedEvent>(
          service_,
          [this, k, later = later_ms[k]] {
            ++worked_;
            timers_[k]->update_interval_millisec(later);
            return true;
          },
          0.001));
      timers_.back()->restart_timer();
    }
  }

  Timers(const Timers&) = delete;
  Timers& operator=(const Timers&) = delete;
  /// Removes timers while the library's thread permits changes of their lists.
  ~Timers() {
    service_.init_thread();
    timers_.clear();
    service_.stop_thread();
  }

  void run_due() {
    look_at_the_clock(&service_);
    run_due_timers(&service_);
  }

  std::size_t worked() const { return worked_; }
  std::size_t waiting() const { return active(service_).size(); }

  bool in_order() const {
    std::vector<double> remaining_ms;
    for (const rtps::TimedEventImpl* timer : active(service_)) {
      const auto found = std::ranges::find_if(
          timers_, [&](const auto& event) { return timer_of(*event) == timer; });
      remaining_ms.push_back((*found)->getRemainingTimeMilliSec());
    }
    return std::ranges::adjacent_find(remaining_ms, [](double earlier, double later) {
             return earlier > later + kApart_ms / 2;
           }) == remaining_ms.end();
  }

 private:
  rtps::ResourceEvent service_;
  std::vector<std::unique_ptr<rtps::TimedEvent>> timers_;
  std::size_t worked_ = 0;
};

TEST(TimerOrder, IsThatOfTheirTimesWheneverSomeHaveWorked) {
  let_timers_end_alone();
  // Timers run in a separate thread, as in the library: the thread of the tests must not be one of
  // those that run timers.
  std::thread([] {
    Timers timers;
    for (std::size_t n = 0; n < 4 * kTimers && timers.worked() < kTimers; ++n) {
      timers.run_due();
      ASSERT_TRUE(timers.in_order()) << timers.worked();
    }
    EXPECT_EQ(timers.worked(), kTimers);
    EXPECT_EQ(timers.waiting(), kTimers);
  }).join();
}

}  // namespace
}  // namespace topogeo::messaging
