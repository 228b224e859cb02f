// Work that would block the loop of a service for too long: one job at a time, in a thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "topogeo/messaging/event_loop.hpp"

namespace topogeo::web {

class Background {
 public:
  /// The rest of a job, called in the loop.
  using Rest = std::function<void()>;
  using Job = std::function<Rest()>;
  /// Largest number of jobs waiting for the current one.
  static constexpr std::size_t kMostJobs = 4;

  /// `loop` must outlive it.
  explicit Background(messaging::EventLoop& loop);
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  /// Waits for the current job and drops the others.
  ~Background();

  /// False when too many jobs wait. The job must not throw; its result is called in the loop unless
  /// this object is gone by then.
  bool run(Job job);

 private:
  void work();

  messaging::EventLoop& loop_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace topogeo::web
