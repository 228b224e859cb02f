#include "server/request_queue.hpp"

namespace topogeo::web {

void RequestQueue::push(Request request, Respond respond) {
  const std::scoped_lock lock(mutex_);
  std::deque<Entry>& queue = request.authorized ? authorized_ : others_;
  queue.emplace_back(std::move(request), std::move(respond));
}

std::deque<RequestQueue::Entry> RequestQueue::take() {
  const std::scoped_lock lock(mutex_);
  std::deque<Entry> taken = std::exchange(authorized_, {});
  if (!others_.empty()) {
    taken.push_back(std::move(others_.front()));
    others_.pop_front();
  }
  return taken;
}

bool RequestQueue::empty() const {
  const std::scoped_lock lock(mutex_);
  return authorized_.empty() && others_.empty();
}

}  // namespace topogeo::web
