// Linked into programs with the thread sanitizer, which in GCC 12 does not know
// pthread_mutex_clocklock: mutexes that Fast DDS locks by it would seem never to be locked, and all
// that they guard to race.
#include <ctime>

#include <pthread.h>

namespace {

constexpr long kSecond_ns = 1'000'000'000;

timespec now(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return time;
}

}  // namespace

extern "C" int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock,
                                       const timespec* until) {
  const timespec from = now(clock);
  timespec end = now(CLOCK_REALTIME);
  end.tv_sec += until->tv_sec - from.tv_sec;
  end.tv_nsec += until->tv_nsec - from.tv_nsec;
  if (end.tv_nsec < 0) {
    end.tv_nsec += kSecond_ns;
    --end.tv_sec;
  } else if (end.tv_nsec >= kSecond_ns) {
    end.tv_nsec -= kSecond_ns;
    ++end.tv_sec;
  }
  return pthread_mutex_timedlock(mutex, &end);
}
