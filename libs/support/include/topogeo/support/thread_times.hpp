// CPU time that the threads of a process have had, and how long they waited for it.
#pragma once

#include <filesystem>
#include <map>

namespace topogeo::support {

struct ThreadTime {
  double ran_s = 0.0;
  double waited_s = 0.0;  ///< ready to run, while other threads or a quota kept the CPU from it
};

/// The threads of the process whose folder of /proc this is, by number. Empty where the process is
/// gone or the kernel does not count these times (schedstat).
std::map<long, ThreadTime> thread_times(const std::filesystem::path& process);

/// The same of the thread that asks; zeros where the kernel does not count.
ThreadTime time_of_this_thread();

/// Their sum; that of threads that have ended is not in it.
ThreadTime sum_of(const std::map<long, ThreadTime>& times);

}  // namespace topogeo::support
