#include "orders/request_table.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::web {

RequestTable::RequestTable(std::string none, double patience_s, double now_s,
                           std::uint64_t first_id)
    : none_(std::move(none)),
      patience_s_(patience_s),
      clock_(now_s, kLongestTick_s),
      last_id_(first_id) {}

void RequestTable::begin(Respond respond, std::function<void(std::uint64_t id)> send,
                         std::function<bool()> heard, double now_s) {
  const std::uint64_t id = ++last_id_;
  Pending& pending = pending_[id];
  pending = {std::move(respond), std::move(send), std::move(heard), clock_.time_s(), now_s, {}};
  pending.send(id);
}

std::optional<Respond> RequestTable::take(std::uint64_t id) {
  const auto found = pending_.find(id);
  if (found == pending_.end()) return std::nullopt;
  Respond respond = std::move(found->second.respond);
  pending_.erase(found);
  return respond;
}

bool RequestTable::is_hopeless(const Pending& request) const {
  const bool heard = request.heard && request.heard();
  return clock_.time_s() - request.since_s >
         (heard ? std::max(patience_s_, kHeard_s) : patience_s_);
}

void RequestTable::tick(double now_s, const std::string& busy) {
  clock_.advance(now_s, busy.empty() ? 1.0 : support::PatienceClock::kBusyRate);
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    auto& [id, request] = *pending;
    if (!busy.empty()) request.busy = busy;
    if (is_hopeless(request)) {
      const std::string reason =
          request.busy.empty() ? "" : "; this machine is too busy: " + request.busy;
      request.respond(error_answer(503, none_ + reason));
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
