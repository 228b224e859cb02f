// In Fast DDS 2.9.1, and in later versions, whoever takes a timer away waits until all timers of
// the participant that are due have done their work (ResourceEvent::unregister_timer). A writer
// that has gone is removed with the lock of discovery held. When one of its timers is at work then,
// it is taken away and waited for; when the timer of liveliness is due after it, that waits for the
// lock. Both wait for ever, and with them all that is received and sent.
//
// Here a timer's end waits for that timer only. While one is at work the lists of timers may be
// changed; the library looks at them anew afterwards, as it does for a timer that removes another.
// Each function here takes the place of one of the library, which calls it through its symbol.
// Should a library have no such function, nothing calls the one here.
#include "timer_waits.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

#include <fastdds/rtps/resources/ResourceEvent.h>
#include <fastdds/rtps/resources/TimedEvent.h>

#include "library_function.hpp"
#include "timer_order.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;
using TimePoint = std::chrono::steady_clock::time_point;

constexpr const char* kWork = "_ZN8eprosima8fastrtps4rtps13ResourceEvent16do_timer_actionsEv";
constexpr const char* kTrigger =
    "_ZN8eprosima8fastrtps4rtps14TimedEventImpl7triggerENSt6chrono10time_pointINS3_3_V212steady_"
    "clockENS3_8durationIlSt5ratioILl1ELl1000000000EEEEEESB_";
constexpr const char* kUnregister =
    "_ZN8eprosima8fastrtps4rtps13ResourceEvent16unregister_timerEPNS1_14TimedEventImplE";
constexpr const char* kCancel = "_ZN8eprosima8fastrtps4rtps10TimedEvent12cancel_timerEv";
constexpr const char* kStopProxy = "_ZN8eprosima8fastrtps4rtps11WriterProxy4stopEv";

// An explicit instantiation may name private members.
template <auto kMutex, auto kAllowed, auto kChanged, auto kLookAnew>
struct ServiceMembers {
  friend void set_lists_open(rtps::ResourceEvent& service, bool open) {
    if (open) service.*kLookAnew = true;
    {
      const std::lock_guard lock(service.*kMutex);
      service.*kAllowed = open;
    }
    if (open) (service.*kChanged).notify_all();
  }
};
/// Whether others may change the lists of timers that `service` goes through.
void set_lists_open(rtps::ResourceEvent& service, bool open);
template struct ServiceMembers<
    &rtps::ResourceEvent::mutex_, &rtps::ResourceEvent::allow_vector_manipulation_,
    &rtps::ResourceEvent::cv_manipulation_, &rtps::ResourceEvent::skip_checking_active_timers_>;

template <auto kTimer>
struct EventMembers {
  friend const void* timer_of(const rtps::TimedEvent& event) { return event.*kTimer; }
};
const void* timer_of(const rtps::TimedEvent& event);
template struct EventMembers<&rtps::TimedEvent::impl_>;

/// Which timers of this process are at work, and which are about to be taken away.
class Timers {
 public:
  /// False for one that is about to be taken away: it is not begun.
  bool begin(const void* timer) {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(leaving_, timer) != leaving_.end()) return false;
    working_.push_back(timer);
    return true;
  }

  void end(const void* timer) {
    {
      const std::lock_guard lock(mutex_);
      working_.erase(std::ranges::find(working_, timer));
    }
    changed_.notify_all();
  }

  void wait_for_end(const void* timer) {
    std::unique_lock lock(mutex_);
    wait_for_end(timer, lock);
  }

  /// From here to left() it is not begun.
  void leave(const void* timer) {
    std::unique_lock lock(mutex_);
    leaving_.push_back(timer);
    wait_for_end(timer, lock);
  }

  void wait_until_left(const void* timer) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return std::ranges::find(leaving_, timer) == leaving_.end(); });
  }

  void left(const void* timer) {
    {
      const std::lock_guard lock(mutex_);
      leaving_.erase(std::ranges::find(leaving_, timer));
    }
    changed_.notify_all();
  }

 private:
  void wait_for_end(const void* timer, std::unique_lock<std::mutex>& lock) {
    changed_.wait(lock, [&] { return std::ranges::find(working_, timer) == working_.end(); });
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<const void*> working_;  // one of each participant
  std::vector<const void*> leaving_;
};

/// Stays to the end of the process: the library's threads may outlive static objects.
Timers& timers() {
  static auto* all = new Timers;  // NOLINT(*-owning-memory)
  return *all;
}

/// Whose timers this thread runs, if it does.
thread_local rtps::ResourceEvent* t_service = nullptr;
thread_local bool t_stops_proxy = false;

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" void topogeo_do_timer_actions(rtps::ResourceEvent* service) __asm__(
    "_ZN8eprosima8fastrtps4rtps13ResourceEvent16do_timer_actionsEv");
extern "C" void topogeo_trigger_timer(void* timer, TimePoint now, TimePoint cancelled) __asm__(
    "_ZN8eprosima8fastrtps4rtps14TimedEventImpl7triggerENSt6chrono10time_pointINS3_3_V212steady_"
    "clockENS3_8durationIlSt5ratioILl1ELl1000000000EEEEEESB_");
extern "C" void topogeo_unregister_timer(rtps::ResourceEvent* service, void* timer) __asm__(
    "_ZN8eprosima8fastrtps4rtps13ResourceEvent16unregister_timerEPNS1_14TimedEventImplE");
extern "C" void topogeo_cancel_timer(rtps::TimedEvent* event) __asm__(
    "_ZN8eprosima8fastrtps4rtps10TimedEvent12cancel_timerEv");
extern "C" void topogeo_stop_writer_proxy(void* proxy) __asm__(
    "_ZN8eprosima8fastrtps4rtps11WriterProxy4stopEv");
// NOLINTEND

extern "C" void topogeo_do_timer_actions(rtps::ResourceEvent* service) {
  static const auto original =
      topogeo::messaging::library_function<void (*)(rtps::ResourceEvent*)>(kWork);
  t_service = service;
  topogeo::messaging::begin_timer_round();
  original(service);
}

extern "C" void topogeo_trigger_timer(void* timer, TimePoint now, TimePoint cancelled) {
  using Function = void (*)(void*, TimePoint, TimePoint);
  static const auto original = topogeo::messaging::library_function<Function>(kTrigger);
  if (t_service == nullptr) {
    original(timer, now, cancelled);
    return;
  }
  const bool begun = timers().begin(timer);  // first: then it cannot go
  set_lists_open(*t_service, true);
  if (begun) {
    topogeo::messaging::note_timer_worked(timer);
    original(timer, now, cancelled);
  } else {
    timers().wait_until_left(timer);
  }
  set_lists_open(*t_service, false);
  if (begun) timers().end(timer);
}

extern "C" void topogeo_unregister_timer(rtps::ResourceEvent* service, void* timer) {
  using Function = void (*)(rtps::ResourceEvent*, void*);
  static const auto original = topogeo::messaging::library_function<Function>(kUnregister);
  if (t_service == service) {  // a timer takes itself or another one away
    original(service, timer);
    return;
  }
  timers().leave(timer);
  original(service, timer);
  timers().left(timer);
}

// The proxy of a remote writer has two timers, cancels both, and takes only one of them away.
extern "C" void topogeo_stop_writer_proxy(void* proxy) {
  static const auto original = topogeo::messaging::library_function<void (*)(void*)>(kStopProxy);
  t_stops_proxy = t_service == nullptr;
  original(proxy);
  t_stops_proxy = false;
}

extern "C" void topogeo_cancel_timer(rtps::TimedEvent* event) {
  static const auto original =
      topogeo::messaging::library_function<void (*)(rtps::TimedEvent*)>(kCancel);
  original(event);
  if (t_stops_proxy) timers().wait_for_end(timer_of(*event));
}

namespace topogeo::messaging {

void let_timers_end_alone() {}

}  // namespace topogeo::messaging
