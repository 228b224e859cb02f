#include "topogeo/support/thread_times.hpp"

#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>

namespace topogeo::support {

namespace fs = std::filesystem;

std::map<long, ThreadTime> thread_times(const fs::path& process) {
  constexpr double kNanosecond_s = 1e-9;
  std::map<long, ThreadTime> times;
  std::error_code error;
  for (fs::directory_iterator task(process / "task", error), end; !error && task != end;
       task.increment(error)) {
    std::ifstream file(task->path() / "schedstat");  // ns on a CPU, ns waiting for one, turns
    double ran_ns = 0.0;
    double waited_ns = 0.0;
    if (!(file >> ran_ns >> waited_ns)) continue;  // it has just ended
    const long number = std::strtol(task->path().filename().c_str(), nullptr, 10);
    times[number] = {ran_ns * kNanosecond_s, waited_ns * kNanosecond_s};
  }
  return times;
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
