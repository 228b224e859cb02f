#include "topogeo/support/thread_times.hpp"

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>

namespace topogeo::support {

namespace fs = std::filesystem;

namespace {

/// Times of the thread with this folder of /proc; empty if it has just ended.
std::optional<ThreadTime> time_of(const fs::path& thread) {
  constexpr double kNanosecond_s = 1e-9;
  std::ifstream file(thread / "schedstat");  // ns on a CPU, ns waiting for one, turns
  double ran_ns = 0.0;
  double waited_ns = 0.0;
  if (!(file >> ran_ns >> waited_ns)) return std::nullopt;
  return ThreadTime{ran_ns * kNanosecond_s, waited_ns * kNanosecond_s};
}

}  // namespace

std::map<long, ThreadTime> thread_times(const fs::path& process) {
  std::map<long, ThreadTime> times;
  std::error_code error;
  for (fs::directory_iterator task(process / "task", error), end; !error && task != end;
       task.increment(error)) {
    const std::optional<ThreadTime> time = time_of(task->path());
    if (!time) continue;
    times[std::strtol(task->path().filename().c_str(), nullptr, 10)] = *time;
  }
  return times;
}

ThreadTime time_of_this_thread() {
  return time_of("/proc/thread-self").value_or(ThreadTime{});
}

ThreadTime sum_of(const std::map<long, ThreadTime>& times) {
  ThreadTime sum;
  for (const auto& [number, time] : times) {
    sum.ran_s += time.ran_s;
    sum.waited_s += time.waited_s;
  }
  return sum;
}

}  // namespace topogeo::support
