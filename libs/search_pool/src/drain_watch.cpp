#include "topogeo/search_pool/drain_watch.hpp"

namespace topogeo::search_pool {

bool DrainWatch::goes_on(double now_s, std::size_t open, bool busy) {
  const double time_s = clock_.advance(now_s, busy ? support::PatienceClock::kBusyRate : 1.0);
  if (open > 0) quiet_since_s_ = now_s;
  if (open < fewest_) {
    fewest_ = open;
    got_on_s_ = time_s;
  }
  return now_s - quiet_since_s_ <= kQuiet_s && time_s - got_on_s_ <= kStuck_s;
}

}  // namespace topogeo::search_pool
