// Linked into programs with the thread sanitizer. GCC 12's does not know pthread_mutex_clocklock,
// with which Fast DDS locks: it would take these mutexes as never locked, and report races on all
// that they guard.
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
