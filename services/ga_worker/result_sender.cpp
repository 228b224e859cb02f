#include "result_sender.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::ga_worker {

namespace {

/// Many short searches, and little beside the time of a batch that has so many tasks.
constexpr std::chrono::milliseconds kLongestWait{40};

}  // namespace

ResultSender::ResultSender(service::Service& service, std::string worker_id,
                           const search_pool::ClientRegistry& clients,
                           search_pool::OutcomeQueue& outcomes, std::function<void()> collect)
    : service_(service),
      worker_id_(std::move(worker_id)),
      clients_(clients),
      outcomes_(outcomes),
      collect_(std::move(collect)),
      results_(service.advertise<msg::MatchResults>()) {}

void ResultSender::expect(const std::string& client_id, std::size_t tasks) {
  outboxes_[client_id].tasks_in_hand += tasks;
  tell_when_to_wake();
}

void ResultSender::add(const std::string& client_id, msg::MatchResult result,
                       std::int64_t stamp_ns) {
  const auto found = outboxes_.find(client_id);
  if (found == outboxes_.end()) return;  // nobody waits for it any more
  Outbox& outbox = found->second;
  outbox.answers.push_back({std::move(result), stamp_ns, Clock::now()});
  if (outbox.tasks_in_hand > 0) --outbox.tasks_in_hand;
  if (until_due(outbox) == 0) {
    send(client_id, outbox);
  } else {
    wait_for_more();
  }
  tell_when_to_wake();
}

std::size_t ResultSender::until_due(const Outbox& outbox) {
  const std::size_t waiting = outbox.answers.size();
  const std::size_t most = msg::kMaxTasksInMessage;
  if (waiting >= std::min(outbox.tasks_in_hand, most)) return 0;
  // Each one more that waits is one less in hand.
  return std::min((outbox.tasks_in_hand - waiting + 1) / 2, most - waiting);
}

void ResultSender::tell_when_to_wake() {
  std::size_t least = msg::kMaxTasksInMessage;
  for (const auto& [client_id, outbox] : outboxes_) {
    if (outbox.tasks_in_hand == 0) continue;
    // The first one sets the timer.
    least = outbox.answers.empty() ? 1 : std::clamp<std::size_t>(until_due(outbox), 1, least);
    if (least == 1) break;
  }
  outcomes_.wake_at(least);
}

void ResultSender::wait_for_more() {
  if (timer_) return;
  std::optional<Clock::time_point> oldest;
  for (const auto& [client_id, outbox] : outboxes_) {
    if (outbox.answers.empty() || !is_reachable(client_id)) continue;
    const Clock::time_point since = outbox.answers.front().since;
    if (!oldest || since < *oldest) oldest = since;
  }
  if (!oldest) return;
  std::chrono::nanoseconds left = *oldest + kLongestWait - Clock::now();
  if (left.count() <= 0) left = kLongestWait;  // its client takes nothing at the moment
  timer_ = service_.loop().call_after(left, [this] {
    timer_.reset();
    send_old();
  });
}

void ResultSender::send_old() {
  collect_();
  const Clock::time_point due = Clock::now() - kLongestWait;
  for (auto& [client_id, outbox] : outboxes_) {
    if (!outbox.answers.empty() && outbox.answers.front().since <= due) send(client_id, outbox);
  }
  wait_for_more();
  tell_when_to_wake();
}

void ResultSender::send_all() {
  collect_();
  for (auto& [client_id, outbox] : outboxes_) send(client_id, outbox);
  tell_when_to_wake();
}

bool ResultSender::is_reachable(const std::string& client_id) const {
  const search_pool::ClientRegistry::Client* client = clients_.find(client_id);
  return client != nullptr && clients_.is_connected(client->participant);
}

void ResultSender::send(const std::string& client_id, Outbox& outbox) {
  if (!is_reachable(client_id)) return;
  while (!outbox.answers.empty()) {
    if (send_message(client_id, outbox)) continue;
    service_.status().fault("send blocked", "client " + client_id);
    return;
  }
}

bool ResultSender::send_message(const std::string& client_id, Outbox& outbox) {
  service::MatchAddress address;
  address.robot_id = clients_.find(client_id)->robot_id;  // which is reachable
  address.stamp_ns = outbox.answers.front().stamp_ns;
  address.sequence_number = messages_sent_;
  address.worker_id = worker_id_;
  address.client_id = client_id;
  msg::MatchResults message = service::results_for(address);
  const std::size_t count = std::min<std::size_t>(outbox.answers.size(), msg::kMaxTasksInMessage);
  const auto end = outbox.answers.begin() + static_cast<std::ptrdiff_t>(count);
  std::transform(outbox.answers.begin(), end, std::back_inserter(message.results()),
                 [](const Answer& answer) { return answer.result; });
  if (!results_.write(message)) return false;
  outbox.answers.erase(outbox.answers.begin(), end);
  ++messages_sent_;
  return true;
}

void ResultSender::drop_older(Clock::time_point before) {
  for (auto& [client_id, outbox] : outboxes_) {
    std::erase_if(outbox.answers, [&](const Answer& answer) { return answer.since < before; });
  }
  tell_when_to_wake();
}

void ResultSender::forget(const std::string& client_id) {
  outboxes_.erase(client_id);
  tell_when_to_wake();
  // The writer has room for a limited number of instances, and a client is one.
  msg::MatchResults result;
  messaging::set_client_id(result, client_id);
  results_.dispose(result);
}

std::size_t ResultSender::waiting() const {
  std::size_t sum = 0;
  for (const auto& [client_id, outbox] : outboxes_) sum += outbox.answers.size();
  return sum;
}

void ResultSender::wait_for_acknowledgments(std::chrono::nanoseconds patience) {
  static_cast<void>(results_.wait_for_acknowledgments(patience));
}

}  // namespace topogeo::ga_worker
