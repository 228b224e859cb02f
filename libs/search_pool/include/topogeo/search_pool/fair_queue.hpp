// A queue that serves its users in turn: a user with a long queue does not delay the others.
#pragma once

#include <cstddef>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace topogeo::search_pool {

/// First in, first out for each user; users in turn. A user who starts with an empty queue is last
/// in turn. Not thread-safe.
template <class Item>
class FairQueue {
 public:
  void push(const std::string& user, Item item) {
    const auto [queue, is_new] = queues_.try_emplace(user);
    if (is_new) turns_.push_back(user);
    queue->second.push_back(std::move(item));
    ++size_;
  }

  /// The oldest item of the user whose turn it is; empty if all queues are empty.
  std::optional<Item> pop() {
    if (turns_.empty()) return {};
    const auto queue = queues_.find(turns_.front());
    std::optional<Item> item = std::move(queue->second.front());
    queue->second.pop_front();
    --size_;
    if (queue->second.empty()) {
      queues_.erase(queue);
      turns_.pop_front();
    } else {
      turns_.splice(turns_.end(), turns_, turns_.begin());
    }
    return item;
  }

  /// Removes and returns all items of a user, oldest first.
  std::deque<Item> remove(const std::string& user) {
    const auto queue = queues_.find(user);
    if (queue == queues_.end()) return {};
    std::deque<Item> items = std::move(queue->second);
    queues_.erase(queue);
    turns_.remove(user);
    size_ -= items.size();
    return items;
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
  std::map<std::string, std::deque<Item>> queues_;  // none is empty
  std::list<std::string> turns_;                    // every user with a queue, next first
  std::size_t size_ = 0;
};

}  // namespace topogeo::search_pool
