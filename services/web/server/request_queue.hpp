// Requests on their way to the loop of the service.
#pragma once

#include <deque>
#include <mutex>
#include <utility>

#include "server/web_types.hpp"

namespace topogeo::web {

/// Requests with the operator's token come first, in their order. The others come one at a time, so
/// that between two of them the loop does everything else: strangers hold up neither orders nor the
/// watchdog. Thread-safe.
class RequestQueue {
 public:
  using Entry = std::pair<Request, Respond>;

  void push(Request request, Respond respond);
  /// All requests with the token and at most one without it.
  [[nodiscard]] std::deque<Entry> take();
  [[nodiscard]] bool empty() const;

 private:
  mutable std::mutex mutex_;
  std::deque<Entry> authorized_;
  std::deque<Entry> others_;
};

}  // namespace topogeo::web
