// Work that takes longer than the loop of a service may stand: one thing at a time, in a thread.
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
  /// What is left to do in the loop.
  using Rest = std::function<void()>;
  using Job = std::function<Rest()>;
  /// So many wait for the one that is worked on.
  static constexpr std::size_t kMostJobs = 4;

  /// `loop` outlives it.
  explicit Background(messaging::EventLoop& loop);
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  /// Waits for the job that is worked on, forgets the others.
  ~Background();

  /// False when too many wait. The job must not throw; what it returns is called in the loop,
  /// unless this is gone by then.
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
