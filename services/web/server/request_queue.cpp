#include "server/request_queue.hpp"

namespace topogeo::web {

bool RequestQueue::push(Request request, Respond respond) {
  const std::scoped_lock lock(mutex_);
  const bool was_empty = authorized_.empty() && others_.empty();
  std::deque<Entry>& queue = request.authorized ? authorized_ : others_;
  queue.emplace_back(std::move(request), std::move(respond));
  return was_empty;
}

RequestQueue::Turn RequestQueue::take() {
  const std::scoped_lock lock(mutex_);
  Turn turn{std::exchange(authorized_, {})};
  if (!others_.empty()) {
    turn.requests.push_back(std::move(others_.front()));
    others_.pop_front();
  }
  turn.more = !others_.empty();
  return turn;
}

}  // namespace topogeo::web
