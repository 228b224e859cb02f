// Makes answers and messages in a thread of its own, so that the thread of the connections, which
// carries Stop, never waits for one.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace topogeo::web {

class AnswerThread {
 public:
  /// Work for operators is done before all other.
  enum class Turn : std::uint8_t { kFirst, kLater };

  AnswerThread();
  AnswerThread(const AnswerThread&) = delete;
  AnswerThread& operator=(const AnswerThread&) = delete;
  ~AnswerThread();

  /// For any thread. After stop() nothing is done.
  void post(Turn turn, std::function<void()> work);
  /// Ends after the work that is being done, and drops the rest.
  void stop();

 private:
  void run();
  std::function<void()> next();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> first_;
  std::deque<std::function<void()>> later_;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace topogeo::web
