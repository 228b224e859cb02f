#include "verdict_channel.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::map_store {
namespace {

constexpr std::chrono::seconds kPeriod{2};
constexpr int kShare = 20;

}  // namespace

VerdictChannel::VerdictChannel(service::Service& service, const storage::MapDatabase& database,
                               Keep keep)
    : database_(database),
      keep_(std::move(keep)),
      verdicts_(database.loop_verdicts(), database.numbered_since()) {
  service.subscribe<msg::LoopDecisions>(
      [this](const msg::LoopDecisions& decisions, const messaging::SampleInfo& info) {
        verdicts_.add(decisions, info.writer);
      });
}

void VerdictChannel::store(bool now) {
  if (verdicts_.changes() == stored_ || (!now && Clock::now() < next_)) return;
  // The stops have other numbers in the database until their trajectory is stored.
  if (verdicts_.numbered_since() != database_.numbered_since()) return;
  const auto start = Clock::now();
  std::vector<storage::LoopVerdict> all = verdicts_.all();
  const std::size_t count = all.size();
  const auto usable = within(std::move(all), database_.local_map_count());
  if (keep_(usable) && usable.size() == count) stored_ = verdicts_.changes();
  const auto end = Clock::now();
  next_ = end + std::max<Clock::duration>(kPeriod, kShare * (end - start));
}

}  // namespace topogeo::map_store
