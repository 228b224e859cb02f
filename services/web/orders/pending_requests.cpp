#include "orders/pending_requests.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <utility>

#include "topogeo/support/cpu_time.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kRequestTick{100};
constexpr double kSendAgain_s = 1.0;
/// A tick that comes later shows that this service did not run: replies may be unread.
constexpr double kLongestTick_s = 0.5;
/// Six programs that want one CPU make an answer take six times as long.
constexpr double kBusyPatience = 6.0;
/// A service that is connected answers late, not never: the order would be carried out all the
/// same.
constexpr double kConnected_s = 60.0;

}  // namespace

PendingRequests::PendingRequests(service::Service& service, std::string none, double patience_s)
    : service_(service),
      none_(std::move(none)),
      patience_s_(patience_s),
      last_tick_s_(support::monotonic_s()),
      last_id_(std::uint64_t{std::random_device{}()} << 16U) {
  timer_ = service_.loop().add_timer(kRequestTick, [this] { tick(); });
}

PendingRequests::~PendingRequests() {
  service_.loop().cancel_timer(timer_);
}

void PendingRequests::begin(Respond respond, std::function<void(std::uint64_t id)> send,
                            std::function<bool()> heard) {
  const std::uint64_t id = ++last_id_;
  Pending& pending = pending_[id];
  pending = {std::move(respond), std::move(send), std::move(heard), 0.0, support::monotonic_s()};
  pending.send(id);
}

std::optional<Respond> PendingRequests::take(std::uint64_t id) {
  const auto found = pending_.find(id);
  if (found == pending_.end()) return std::nullopt;
  Respond respond = std::move(found->second.respond);
  pending_.erase(found);
  return respond;
}

void PendingRequests::tick() {
  const double now_s = support::monotonic_s();
  const double passed_s = std::min(now_s - std::exchange(last_tick_s_, now_s), kLongestTick_s);
  const bool busy = service_.cpu().lasts();
  const double patience_s = busy ? kBusyPatience * patience_s_ : patience_s_;
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    auto& [id, request] = *pending;
    request.waited_s += passed_s;
    const bool there = request.heard && request.heard();
    if (request.waited_s > (there ? std::max(patience_s, kConnected_s) : patience_s)) {
      request.respond(error_answer(
          503, busy ? none_ + "; this machine is too busy: " + service_.cpu().text() : none_));
      pending = pending_.erase(pending);
      continue;
    }
    if (now_s - request.sent_s > kSendAgain_s) {
      request.sent_s = now_s;
      request.send(id);
    }
    ++pending;
  }
}

}  // namespace topogeo::web
