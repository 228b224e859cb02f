// Requests on their way to the loop of the service.
#pragma once

#include <deque>
#include <mutex>
#include <utility>

#include "server/web_types.hpp"

namespace topogeo::web {

/// Requests with the operator's token come first, in their order. The others come one in each turn
/// of the loop, which does everything else in between: strangers hold up neither orders nor the
/// watchdog. Thread-safe.
class RequestQueue {
 public:
  using Entry = std::pair<Request, Respond>;

  struct Turn {
    std::deque<Entry> requests;
    bool more = false;  ///< take() has to be called once more
  };

  /// True if the queue was empty: take() has to be called.
  [[nodiscard]] bool push(Request request, Respond respond);
  /// All requests with the token and at most one without it.
  [[nodiscard]] Turn take();

 private:
  std::mutex mutex_;
  std::deque<Entry> authorized_;
  std::deque<Entry> others_;
};

}  // namespace topogeo::web
