#include "orders/unconfirmed_release.hpp"

#include "topogeo/service/base_confirmation.hpp"

namespace topogeo::web {

void UnconfirmedRelease::begin(std::uint64_t stop_count, bool held, std::int64_t now_ns) {
  since_ns_ = now_ns;
  stop_count_ = stop_count;
  held_ = held;
  stopped_again_ = false;
  reported_ = false;
}

std::optional<UnconfirmedRelease::Outcome> UnconfirmedRelease::take(const msg::BaseStatus& status,
                                                                    std::int64_t now_ns) {
  if (!since_ns_ || hides_stop(status)) return std::nullopt;
  if (!service::holds(status)) {
    if (!held_ && now_ns - *since_ns_ < kOnItsWay_ns) return std::nullopt;
    end();
    return Outcome::kReleased;
  }
  held_ = true;
  // The gateway may still allow the release: it counts this client's own stop just before.
  stopped_again_ = status.stop_count() != stop_count_;
  return check(now_ns);
}

std::optional<UnconfirmedRelease::Outcome> UnconfirmedRelease::check(std::int64_t now_ns) {
  if (!since_ns_ || now_ns - *since_ns_ < kPatience_ns) return std::nullopt;
  if (stopped_again_) {
    end();
    return Outcome::kRefused;
  }
  if (reported_) return std::nullopt;
  reported_ = true;
  return Outcome::kUnconfirmed;
}

}  // namespace topogeo::web
