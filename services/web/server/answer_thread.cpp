#include "server/answer_thread.hpp"

#include <utility>

namespace topogeo::web {

AnswerThread::AnswerThread() : thread_([this] { run(); }) {}

AnswerThread::~AnswerThread() {
  stop();
}

void AnswerThread::post(Turn turn, std::function<void()> work) {
  {
    const std::scoped_lock lock(mutex_);
    if (stopped_) return;
    (turn == Turn::kFirst ? first_ : later_).push_back(std::move(work));
  }
  changed_.notify_one();
}

void AnswerThread::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
  first_.clear();
  later_.clear();
}

// Empty at the end.
std::function<void()> AnswerThread::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopped_ || !first_.empty() || !later_.empty(); });
  if (stopped_) return {};
  auto& queue = first_.empty() ? later_ : first_;
  std::function<void()> work = std::move(queue.front());
  queue.pop_front();
  return work;
}

void AnswerThread::run() {
  while (const std::function<void()> work = next()) work();
}

}  // namespace topogeo::web
