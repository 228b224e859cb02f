// Makes answers and messages in a thread of its own, so that the connection thread, which carries
// Stop, never waits for them.
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
  /// Work for operators comes first.
  enum class Turn : std::uint8_t { kFirst, kLater };

  AnswerThread();
  AnswerThread(const AnswerThread&) = delete;
  AnswerThread& operator=(const AnswerThread&) = delete;
  ~AnswerThread();

  /// Thread-safe. Does nothing after stop().
  void post(Turn turn, std::function<void()> work);
  /// Ends after the current work and drops the rest.
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
