// Independent drives, several at a time.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace topogeo::bench {

/// Returns the results of `drive` in the order of the jobs, with so many threads. Rethrows a
/// drive's exception when all threads have ended.
template <typename Row, typename Job, typename Drive>
std::vector<Row> drive_in_parallel(const std::vector<Job>& jobs, unsigned threads_at_a_time,
                                   const Drive& drive) {
  std::vector<Row> rows(jobs.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> errors(threads_at_a_time);
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < threads_at_a_time; ++k) {
    threads.emplace_back([&, k] {
      try {
        for (std::size_t i = next++; i < jobs.size(); i = next++) rows[i] = drive(jobs[i]);
      } catch (...) {
        errors[k] = std::current_exception();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  return rows;
}

}  // namespace topogeo::bench
