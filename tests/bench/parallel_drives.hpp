// Drives that know nothing of each other, several at a time.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace topogeo::bench {

/// What `drive` gives for each job, in their order, with so many threads. Throws what a drive threw
/// when all threads have ended.
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
