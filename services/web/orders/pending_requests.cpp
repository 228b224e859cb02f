#include "orders/pending_requests.hpp"

#include <chrono>
#include <random>
#include <utility>

#include "topogeo/support/cpu_time.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kRequestTick{100};

/// Random, so that ids differ between processes.
std::uint64_t first_request_id() {
  return std::uint64_t{std::random_device{}()} << 16U;
}

}  // namespace

PendingRequests::PendingRequests(service::Service& service, std::string none, double patience_s)
    : service_(service),
      table_(std::move(none), patience_s, support::monotonic_s(), first_request_id()) {
  timer_ = service_.loop().add_timer(
      kRequestTick, [this] { table_.tick(support::monotonic_s(), service_.cpu().text()); });
}

PendingRequests::~PendingRequests() {
  service_.loop().cancel_timer(timer_);
}

void PendingRequests::begin(Respond respond, std::function<void(std::uint64_t id)> send,
                            std::function<bool()> heard) {
  table_.begin(std::move(respond), std::move(send), std::move(heard), support::monotonic_s());
}

}  // namespace topogeo::web
