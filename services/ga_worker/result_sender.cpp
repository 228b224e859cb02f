#include "result_sender.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::ga_worker {

namespace {

/// Long enough for many short searches, and short against a batch with that many tasks.
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
      results_(service.advertise<msg::MatchResults>()),
      outboxes_({msg::kMaxTasksInMessage, kLongestWait}) {}

void ResultSender::expect(const std::string& client_id, std::size_t tasks) {
  outboxes_.expect(client_id, tasks);
  schedule();
}

void ResultSender::add(const std::string& client_id, msg::MatchResult result,
                       std::int64_t stamp_ns) {
  const Clock::time_point now = Clock::now();
  outboxes_.add(client_id, {std::move(result), stamp_ns}, now);
  if (outboxes_.is_due(client_id, now)) send(client_id);
  schedule();
}

void ResultSender::schedule() {
  outcomes_.wake_at(outboxes_.until_due());
  const std::optional<Clock::time_point> due = outboxes_.next_due();
  if (!due || (timer_ && timer_due_ <= *due)) return;
  if (timer_) service_.loop().cancel_timer(*timer_);
  timer_due_ = *due;
  timer_ = service_.loop().call_after(
      std::max<std::chrono::nanoseconds>(std::chrono::nanoseconds::zero(), *due - Clock::now()),
      [this] { send_due(); });
}

void ResultSender::send_due() {
  collect_();
  for (const std::string& client_id : outboxes_.due(Clock::now())) send(client_id);
  timer_.reset();
  schedule();
}

void ResultSender::send_all() {
  collect_();
  for (const std::string& client_id : outboxes_.with_answers()) send(client_id);
  schedule();
}

bool ResultSender::is_reachable(const std::string& client_id) const {
  const search_pool::ClientRegistry::Client* client = clients_.find(client_id);
  return client != nullptr && clients_.is_connected(client->participant);
}

void ResultSender::send(const std::string& client_id) {
  if (!is_reachable(client_id)) {
    outboxes_.blocked(client_id, Clock::now());
    return;
  }
  do {
    if (!send_message(client_id)) {
      service_.status().fault("send blocked", "client " + client_id);
      outboxes_.blocked(client_id, Clock::now());
      return;
    }
  } while (outboxes_.sent(client_id));
}

bool ResultSender::send_message(const std::string& client_id) {
  const std::vector<const Answer*> answers = outboxes_.next_message(client_id);
  service::MatchAddress address;
  address.robot_id = clients_.find(client_id)->robot_id;  // the client is reachable, hence known
  address.stamp_ns = answers.front()->stamp_ns;
  address.sequence_number = messages_sent_;
  address.worker_id = worker_id_;
  address.client_id = client_id;
  msg::MatchResults message = service::results_for(address);
  std::transform(answers.begin(), answers.end(), std::back_inserter(message.results()),
                 [](const Answer* answer) { return answer->result; });
  if (!results_.write(message)) return false;
  ++messages_sent_;
  return true;
}

void ResultSender::drop_older(Clock::time_point before) {
  outboxes_.drop_older(before);
  schedule();
}

void ResultSender::forget(const std::string& client_id) {
  outboxes_.forget(client_id);
  schedule();
  // The writer has room for a limited number of instances, one per client.
  msg::MatchResults result;
  messaging::set_client_id(result, client_id);
  results_.dispose(result);
}

void ResultSender::wait_for_acknowledgments(std::chrono::nanoseconds patience) {
  static_cast<void>(results_.wait_for_acknowledgments(patience));
}

}  // namespace topogeo::ga_worker
