// Fast DDS 2.9.1 sorts all timers of a participant whenever one has worked, and each comparison
// locks both: with a thousand timers, which a hundred peers make, half of the CPU time of a service
// went there. Only timers that have worked are out of order, and here only those are moved.
//
// Each function here takes the place of one of the library, which calls it through its symbol.
// Should a library have no such function, nothing calls the one here.
#include "timer_order.hpp"

#include <algorithm>
#include <vector>

#include <fastdds/rtps/resources/ResourceEvent.h>

#include "library_function.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;
using Timer = rtps::TimedEventImpl*;
/// Of two timers: whether the first works earlier.
using Earlier = bool (*)(Timer, Timer);

constexpr const char* kSortTimers = "_ZN8eprosima8fastrtps4rtps13ResourceEvent11sort_timersEv";
constexpr const char* kSortRange =
    "_ZSt16__introsort_loopIN9__gnu_cxx17__normal_iteratorIPPN8eprosima8fastrtps4rtps14"
    "TimedEventImplESt6vectorIS6_SaIS6_EEEElNS0_5__ops15_Iter_comp_iterIPFbS6_S6_EEEEvT_SH_T0_T1_";

// An explicit instantiation may name private members.
template <auto kActive>
struct OrderMembers {
  friend std::vector<Timer>& active_timers(rtps::ResourceEvent& service) {
    return service.*kActive;
  }
};
/// Those that wait for their time, the earliest first.
std::vector<Timer>& active_timers(rtps::ResourceEvent& service);
template struct OrderMembers<&rtps::ResourceEvent::active_timers_>;

thread_local std::vector<const void*> t_worked;
/// The library's comparison, which it gives to its sorting only.
thread_local Earlier t_earlier = nullptr;

void move_those_that_worked(std::vector<Timer>& timers) {
  std::ranges::sort(t_worked);
  const auto worked = std::stable_partition(timers.begin(), timers.end(), [](const Timer& timer) {
    return !std::ranges::binary_search(t_worked, static_cast<const void*>(timer));
  });
  for (auto next = worked; next != timers.end(); ++next) {
    std::rotate(std::upper_bound(timers.begin(), next, *next, t_earlier), next, next + 1);
  }
}

}  // namespace

// NOLINTBEGIN: the names of functions of the library
extern "C" void topogeo_sort_timers(rtps::ResourceEvent* service) __asm__(
    "_ZN8eprosima8fastrtps4rtps13ResourceEvent11sort_timersEv");
extern "C" void topogeo_sort_range(Timer* first, Timer* last, long depth, Earlier earlier) __asm__(
    "_ZSt16__introsort_loopIN9__gnu_cxx17__normal_iteratorIPPN8eprosima8fastrtps4rtps14"
    "TimedEventImplESt6vectorIS6_SaIS6_EEEElNS0_5__ops15_Iter_comp_iterIPFbS6_S6_EEEEvT_SH_T0_T1_");
// NOLINTEND

extern "C" void topogeo_sort_timers(rtps::ResourceEvent* service) {
  static const auto original =
      topogeo::messaging::library_function<void (*)(rtps::ResourceEvent*)>(kSortTimers);
  if (t_earlier == nullptr) {
    original(service);
  } else {
    move_those_that_worked(active_timers(*service));
  }
}

// A template of the standard library, compiled into the middleware for its timers.
extern "C" void topogeo_sort_range(Timer* first, Timer* last, long depth,  // NOLINT(*-runtime-int)
                                   Earlier earlier) {
  using Function = void (*)(Timer*, Timer*, long, Earlier);  // NOLINT(*-runtime-int)
  static const auto original = topogeo::messaging::library_function<Function>(kSortRange);
  t_earlier = earlier;
  original(first, last, depth, earlier);
}

namespace topogeo::messaging {

void begin_timer_round() {
  t_worked.clear();
}

void note_timer_worked(const void* timer) {
  t_worked.push_back(timer);
}

}  // namespace topogeo::messaging
