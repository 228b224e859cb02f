// CPU time used by the threads of a process, and their waiting time.
#pragma once

#include <filesystem>
#include <map>

namespace topogeo::support {

struct ThreadTime {
  double ran_s = 0.0;
  double waited_s = 0.0;  ///< ready to run, while other threads or a quota kept the CPU from it
};

/// The threads of the process with this folder of /proc, by number. Empty if the process is gone or
/// the kernel does not count these times (schedstat).
std::map<long, ThreadTime> thread_times(const std::filesystem::path& process);

/// Times of the calling thread; zeros if the kernel does not count them.
ThreadTime time_of_this_thread();

/// Sum over these threads, without those that have ended.
ThreadTime sum_of(const std::map<long, ThreadTime>& times);

}  // namespace topogeo::support
