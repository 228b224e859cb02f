// Schedule of a worker's answers: several share a message if more are about to come.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace topogeo::search_pool {

struct OutboxRules {
  std::size_t most_together = 1;  ///< limit of answers per message
  std::chrono::nanoseconds longest_wait{};
};

/// An outbox for each client. Its answers are due when they are as many as its remaining tasks,
/// when they fill a message, or when the oldest has waited long enough. Has no clock: the caller
/// passes the time. Not thread-safe.
template <class Answer>
class Outboxes {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit Outboxes(const OutboxRules& rules) : rules_(rules) {}

  /// This many tasks of the client have arrived; add() must follow for each.
  void expect(const std::string& client_id, std::size_t tasks) {
    boxes_[client_id].in_hand += tasks;
  }

  /// Adds the answer to one of those tasks. Dropped if the client is gone.
  void add(const std::string& client_id, Answer answer, Time now) {
    const auto found = boxes_.find(client_id);
    if (found == boxes_.end()) return;
    Box& box = found->second;
    box.waiting.push_back({std::move(answer), now});
    if (box.in_hand > 0) --box.in_hand;
  }

  /// The clients whose answers are due.
  [[nodiscard]] std::vector<std::string> due(Time now) const {
    std::vector<std::string> clients;
    for (const auto& [client_id, box] : boxes_) {
      if (is_due(box, now)) clients.push_back(client_id);
    }
    return clients;
  }
  [[nodiscard]] bool is_due(const std::string& client_id, Time now) const {
    const auto found = boxes_.find(client_id);
    return found != boxes_.end() && is_due(found->second, now);
  }

  /// The clients with waiting answers.
  [[nodiscard]] std::vector<std::string> with_answers() const {
    std::vector<std::string> clients;
    for (const auto& [client_id, box] : boxes_) {
      if (!box.waiting.empty()) clients.push_back(client_id);
    }
    return clients;
  }

  /// The oldest answers to a client that has some, as many as fit into a message; valid until the
  /// next change.
  [[nodiscard]] std::vector<const Answer*> next_message(const std::string& client_id) const {
    const std::deque<Waiting>& waiting = boxes_.at(client_id).waiting;
    std::vector<const Answer*> answers;
    answers.reserve(together(waiting));
    for (std::size_t i = 0; i < together(waiting); ++i) answers.push_back(&waiting[i].answer);
    return answers;
  }

  /// Removes the answers of that message; true if more wait for the client.
  bool sent(const std::string& client_id) {
    Box& box = boxes_.at(client_id);
    std::deque<Waiting>& waiting = box.waiting;
    box.not_before = {};
    waiting.erase(waiting.begin(),
                  waiting.begin() + static_cast<std::ptrdiff_t>(together(waiting)));
    return !waiting.empty();
  }

  /// The message could not be sent: no answer of the client is due for the longest wait, or until
  /// one has been sent.
  void blocked(const std::string& client_id, Time now) {
    boxes_.at(client_id).not_before = now + rules_.longest_wait;
  }

  void drop_older(Time before) {
    for (auto& [client_id, box] : boxes_) {
      std::erase_if(box.waiting, [&](const Waiting& waiting) { return waiting.since < before; });
    }
  }
  void forget(const std::string& client_id) { boxes_.erase(client_id); }

  /// Time of the next check of due(), whatever happens until then; empty without waiting answers.
  [[nodiscard]] std::optional<Time> next_due() const {
    std::optional<Time> next;
    for (const auto& [client_id, box] : boxes_) {
      if (box.waiting.empty()) continue;
      const Time due =
          std::max(box.not_before, is_full(box) ? box.waiting.front().since : gets_old(box));
      if (!next || due < *next) next = due;
    }
    return next;
  }

  /// Number of answers, at least 1, until due() or next_due() may change.
  [[nodiscard]] std::size_t until_due() const {
    std::size_t least = rules_.most_together;
    bool any = false;
    for (const auto& [client_id, box] : boxes_) {
      if (box.in_hand == 0) continue;
      any = true;
      // The first answer starts the wait.
      const std::size_t of_client =
          box.waiting.empty() ? 1 : std::max<std::size_t>(missing(box), 1);
      least = std::min(least, of_client);
    }
    return any ? least : 1;
  }

  /// Number of waiting answers.
  [[nodiscard]] std::size_t waiting() const {
    std::size_t sum = 0;
    for (const auto& [client_id, box] : boxes_) sum += box.waiting.size();
    return sum;
  }

 private:
  struct Waiting {
    Answer answer;
    Time since;
  };
  struct Box {
    std::size_t in_hand = 0;  // tasks
    std::deque<Waiting> waiting;
    Time not_before{};
  };

  /// Number of answers in the next message.
  [[nodiscard]] std::size_t together(const std::deque<Waiting>& waiting) const {
    return std::min(waiting.size(), rules_.most_together);
  }
  [[nodiscard]] Time gets_old(const Box& box) const {
    return box.waiting.front().since + rules_.longest_wait;
  }
  [[nodiscard]] bool is_full(const Box& box) const {
    return box.waiting.size() >= std::min(box.in_hand, rules_.most_together);
  }
  [[nodiscard]] bool is_due(const Box& box, Time now) const {
    return !box.waiting.empty() && now >= box.not_before && (is_full(box) || now >= gets_old(box));
  }
  /// Number of answers until the box is full. Each new one also reduces the tasks in hand.
  [[nodiscard]] std::size_t missing(const Box& box) const {
    if (is_full(box)) return 0;
    return std::min((box.in_hand - box.waiting.size() + 1) / 2,
                    rules_.most_together - box.waiting.size());
  }

  OutboxRules rules_;
  std::map<std::string, Box> boxes_;  // by client id
};

}  // namespace topogeo::search_pool
