#include "orders/background.hpp"

#include <utility>

namespace topogeo::web {

Background::Background(messaging::EventLoop& loop) : loop_(loop), thread_([this] { work(); }) {}

Background::~Background() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool Background::run(Job job) {
  {
    const std::scoped_lock lock(mutex_);
    if (jobs_.size() >= kMostJobs) return false;
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
  return true;
}

void Background::work() {
  for (;;) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ending_ || !jobs_.empty(); });
      if (ending_) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    Rest rest = job();
    job = nullptr;  // releases its data before the loop may continue
    loop_.post([alive = std::weak_ptr<bool>(alive_), rest = std::move(rest)] {
      if (!alive.expired()) rest();
    });
  }
}

}  // namespace topogeo::web
